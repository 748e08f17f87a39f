import { buildWithPins, type MapVersion, type Report, type Vector } from './api';
import { element } from './dom';
import type { MapView } from './map_view';
import {
  formatPlace,
  formatPoint,
  formatResidual,
  obstacleOf,
  parsePlace,
  parsePoint,
  pinsForRequest,
  pinsOfReport,
  rmsOfPins,
  type Pin,
} from './pins';

/** Where reviewers say where points of the map lie on Earth, and build a version that lies there. */
export class PinPanel {
  private map: MapVersion | null = null;
  private kept: Pin[] = []; // of the version that is shown
  private pins: Pin[] = [];
  private picked: Vector | null = null;

  private readonly list = element('ol', { class: 'pins' });
  private readonly summary = element('p', { class: 'hint' });
  private readonly complaint = element('p', { class: 'hint error', role: 'alert' });
  private readonly point = element('input', {
    id: 'pin-point',
    autocomplete: 'off',
    placeholder: 'click the ground',
    input: () => this.takeTypedPoint(),
  });
  private readonly place = element('input', {
    id: 'pin-place',
    autocomplete: 'off',
    placeholder: '48.137154, 11.576124, 519.3',
  });
  private readonly build = element('button', { type: 'button', class: 'primary', click: () => void this.send() });

  constructor(
    private readonly root: HTMLElement,
    private readonly view: MapView,
    private readonly onQueued: () => void,
  ) {
    const field = (label: string, input: HTMLInputElement) =>
      element('label', { for: input.id }, element('span', {}, label), input);
    const form = element(
      'form',
      { submit: (event) => this.add(event) },
      field('Point of the map, m', this.point),
      field('Latitude, longitude, height', this.place),
      element(
        'div',
        { class: 'row' },
        element('button', { type: 'submit' }, 'Add pin'),
        element('button', { type: 'button', click: () => this.take(this.view.pickMiddle()) }, 'Take the middle'),
      ),
    );
    root.replaceChildren(
      element('h2', {}, 'Pins'),
      this.summary,
      this.list,
      form,
      this.complaint,
      this.build,
    );
    root.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') document.querySelector<HTMLButtonElement>('#toolbar [data-pins]')?.click();
    });
  }

  /** Another version is shown; what was drafted for the one before is gone. */
  show(map: MapVersion, report: Report): void {
    this.map = map;
    this.kept = pinsOfReport(report.pins);
    this.pins = [...this.kept];
    this.take(null);
    this.complain('');
    this.render();
  }

  setOpen(isOpen: boolean): void {
    this.root.hidden = !isOpen;
    this.view.onPick = isOpen ? (point) => this.take(point) : null;
    document.body.classList.toggle('picking', isOpen);
    this.render();
    if (isOpen) this.point.focus();
  }

  private take(point: Vector | null): void {
    this.picked = point;
    this.point.value = point ? formatPoint(point) : '';
    if (point) this.place.focus();
    this.showMarks();
  }

  private takeTypedPoint(): void {
    this.picked = parsePoint(this.point.value);
    this.showMarks();
  }

  private add(event: Event): void {
    event.preventDefault();
    const place = parsePlace(this.place.value);
    if (!this.picked) {
      this.complain('Click a point of the ground, or type its x, y, z');
      this.point.focus();
    } else if (typeof place === 'string') {
      this.complain(place);
      this.place.focus();
    } else {
      this.pins.push({ point: this.picked, ...place, residual: null, isUsed: true });
      this.place.value = '';
      this.take(null);
      this.complain('');
      this.render();
      this.point.focus();
    }
  }

  private remove(pin: Pin): void {
    this.pins = this.pins.filter((other) => other !== pin);
    this.render();
    this.point.focus();
  }

  private async send(): Promise<void> {
    if (!this.map || obstacleOf(this.pins, this.kept)) return;
    this.build.disabled = true;
    try {
      await buildWithPins(this.map, pinsForRequest(this.pins));
      this.complain('');
      this.build.textContent = 'In the queue';
      this.onQueued();
    } catch (error) {
      this.complain(error instanceof Error ? error.message : String(error));
      this.build.disabled = false;
    }
  }

  private complain(text: string): void {
    this.complaint.textContent = text;
    this.complaint.hidden = text === '';
  }

  private render(): void {
    const rms = rmsOfPins(this.kept);
    const obstacle = obstacleOf(this.pins, this.kept);
    this.summary.textContent =
      rms === null ? 'Two points or more that you know put the map where it is.' : `RMS ${(100 * rms).toFixed(1)} cm`;
    this.list.replaceChildren(
      ...this.pins.map((pin, i) =>
        element(
          'li',
          { class: pin.residual ? 'fitted' : 'new' },
          element('span', { class: 'place' }, formatPlace(pin)),
          element('small', {}, formatResidual(pin)),
          element('button', { type: 'button', 'aria-label': `Remove pin ${i + 1}`, click: () => this.remove(pin) }, '×'),
        ),
      ),
    );
    this.build.disabled = obstacle !== null;
    this.build.textContent = obstacle ?? (this.pins.length === 0 ? 'Build without pins' : 'Build a version with these');
    this.showMarks();
  }

  private showMarks(): void {
    const marks = this.root.hidden
      ? []
      : this.pins.map((pin, i) => ({ point: pin.point, label: String(i + 1), isNew: !this.kept.includes(pin) }));
    if (this.picked && !this.root.hidden) marks.push({ point: this.picked, label: '?', isNew: true });
    this.view.setPins(marks);
  }
}

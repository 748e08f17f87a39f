import { element } from './dom';
import type { MapView } from './map_view';
import type { PinPanel } from './pin_panel';

/** Buttons that change how the map is seen. */
export function createToolbar(place: HTMLElement, view: MapView, legend: HTMLElement, pins: PinPanel): void {
  const action = (text: string, run: () => void) => element('button', { type: 'button', click: run }, text);
  const toggle = (text: string, isOn: boolean, change: (isOn: boolean) => void) => {
    const button = element('button', { type: 'button', 'aria-pressed': String(isOn) }, text);
    button.addEventListener('click', () => {
      const next = button.getAttribute('aria-pressed') !== 'true';
      button.setAttribute('aria-pressed', String(next));
      change(next);
    });
    return button;
  };
  const pinToggle = toggle('Pins', false, (isOn) => pins.setOpen(isOn));
  pinToggle.dataset['pins'] = '';
  const surfaceToggle = toggle('Surfaces', false, (isOn) => view.setSurfacesVisible(isOn));
  surfaceToggle.dataset['surfaces'] = '';
  place.replaceChildren(
    toggle('Ground', true, (isOn) => view.setGroundVisible(isOn)),
    toggle('Trajectory', true, (isOn) => view.setTrajectoriesVisible(isOn)),
    toggle('Slots', true, (isOn) => {
      view.setSlotsVisible(isOn);
      legend.classList.toggle('off', !isOn);
    }),
    surfaceToggle,
    toggle('Heights', false, (isOn) => view.setColorMode(isOn ? 'height' : 'photo')),
    pinToggle,
    action('From above', () => view.lookDown()),
    action('Around', () => view.lookAround()),
  );
}

import { element } from './dom';
import type { MapView } from './map_view';

/** Buttons that change how the map is seen. */
export function createToolbar(place: HTMLElement, view: MapView, legend: HTMLElement): void {
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
  place.replaceChildren(
    toggle('Ground', true, (isOn) => view.setGroundVisible(isOn)),
    toggle('Trajectory', true, (isOn) => view.setTrajectoriesVisible(isOn)),
    toggle('Slots', true, (isOn) => {
      view.setSlotsVisible(isOn);
      legend.classList.toggle('off', !isOn);
    }),
    toggle('Heights', false, (isOn) => view.setColorMode(isOn ? 'height' : 'photo')),
    action('From above', () => view.lookDown()),
    action('Around', () => view.lookAround()),
  );
}

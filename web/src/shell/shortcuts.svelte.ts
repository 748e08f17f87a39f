// Keys that do something on the place that is shown. Each place says its own; "?" lists them.

import { untrack } from 'svelte';

export interface Shortcut {
  key: string; // as KeyboardEvent.key has it: "m", "Escape", "ArrowRight"
  about: string;
  run: () => void;
}

class Shortcuts {
  private groups: Shortcut[][] = $state.raw([]);
  isListOpen = $state(false);

  get all(): Shortcut[] {
    return this.groups.flat();
  }

  /** Returns what takes them away again. To be called in $effect. */
  add(shortcuts: Shortcut[]): () => void {
    this.groups = [...untrack(() => this.groups), shortcuts];
    return () => (this.groups = this.groups.filter((group) => group !== shortcuts));
  }

  /** Runs what a key means, the place that came last first; not while somebody types. */
  press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.key !== 'Escape' && isTyping(event.target)) return;
    if (event.key === ' ' && isPressable(event.target)) return; // it is what presses a button
    if (isForTarget(event)) return;
    if (event.key === '?') {
      this.isListOpen = !this.isListOpen;
      event.preventDefault();
      return;
    }
    const found = this.groups.flat().findLast(({ key }) => key === event.key);
    if (!found) return;
    event.preventDefault();
    found.run();
  }
}

const isPressable = (target: EventTarget | null) => target instanceof Element && target.closest('button, a, summary') !== null;

function isTyping(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !/^(checkbox|radio|button|range)$/.test(target.type);
  return target instanceof HTMLElement && (target.isContentEditable || /^(TEXTAREA|SELECT)$/.test(target.tagName));
}

/** What has the focus takes these keys itself: a dialog is closed by Escape, a button pressed by Enter. */
function isForTarget({ key, target }: KeyboardEvent): boolean {
  if (!(target instanceof Element)) return false;
  if (target.closest('dialog')) return key !== '?';
  if (target.matches('input[type="range"]') && /^(Arrow|Page|Home$|End$)/.test(key)) return true;
  return (key === 'Enter' || key === ' ') && target.closest('button, a[href], summary, input') !== null;
}

export const shortcuts = new Shortcuts();

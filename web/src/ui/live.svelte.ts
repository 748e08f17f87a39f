// Something the service answers, asked again whenever it may have changed.

import { watchEvents, type EventKind } from '../api/events';

export class Live<Value> {
  value: Value | undefined = $state.raw(undefined);
  error: string = $state('');
  private asking: Promise<void> | null = null;
  private isWanted = false;

  /** To be made while a component is: it ends with that. `read` must not depend on state. */
  constructor(
    private readonly read: () => Promise<Value>,
    kinds: readonly EventKind[] = [],
  ) {
    $effect(() => {
      void this.refresh();
      return kinds.length > 0 ? watchEvents(kinds, () => void this.refresh()) : undefined;
    });
  }

  /**
   * Events come in bursts: one question at a time, and one more where any came meanwhile. Whoever waits has an answer
   * to a question that was asked after this call.
   */
  refresh(): Promise<void> {
    this.isWanted = true;
    this.asking ??= this.ask();
    return this.asking;
  }

  private async ask(): Promise<void> {
    while (this.isWanted) {
      this.isWanted = false;
      try {
        this.value = await this.read();
        this.error = '';
      } catch (error) {
        this.error = error instanceof Error ? error.message : String(error);
      }
    }
    this.asking = null;
  }
}

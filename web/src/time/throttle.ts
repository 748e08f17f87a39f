// What may come often is done now and then: at once at first, and the last of what came meanwhile after a pause.

export class Throttle<Argument> {
  private timer: ReturnType<typeof setTimeout> | null = null;
  private waiting: { argument: Argument } | null = null;

  constructor(
    private readonly run: (argument: Argument) => void,
    private readonly pause: number, // [ms]
  ) {}

  call(argument: Argument): void {
    if (this.timer !== null) {
      this.waiting = { argument };
      return;
    }
    this.run(argument);
    this.timer = setTimeout(() => {
      this.timer = null;
      const { waiting } = this;
      this.waiting = null;
      if (waiting) this.call(waiting.argument);
    }, this.pause);
  }

  /** Does now what waits. */
  flush(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
    const { waiting } = this;
    this.waiting = null;
    if (waiting) this.run(waiting.argument);
  }
}

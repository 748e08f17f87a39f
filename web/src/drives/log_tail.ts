// A growing text file of the service, read on from where it was read to.

/** Reads what came since the last call. A byte that is known already goes with each question: an empty range is refused. */
export class LogTail {
  private bytesRead = 0;
  private readonly decoder = new TextDecoder();

  constructor(private readonly address: string) {}

  async read(): Promise<string> {
    const from = Math.max(0, this.bytesRead - 1);
    const response = await fetch(this.address, this.bytesRead === 0 ? {} : { headers: { range: `bytes=${from}-` } }).catch(() => {
      throw new Error('the service does not answer');
    });
    if (!response.ok) throw new Error(`the log cannot be read: the service answered ${response.status}`);
    const bytes = new Uint8Array(await response.arrayBuffer());
    const isPart = response.status === 206;
    const fresh = bytes.subarray(isPart ? this.bytesRead - from : this.bytesRead);
    this.bytesRead += fresh.length;
    return this.decoder.decode(fresh, { stream: true });
  }
}

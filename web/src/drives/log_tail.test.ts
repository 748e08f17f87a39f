import { afterEach, expect, test, vi } from 'vitest';

import { LogTail } from './log_tail';

afterEach(() => vi.unstubAllGlobals());

/** A service that has these bytes, and may know no ranges. */
function serve(content: () => Uint8Array<ArrayBuffer>, knowsRanges = true): void {
  vi.stubGlobal('fetch', async (_address: string, init: { headers?: { range: string } }) => {
    const from = knowsRanges ? Number(/\d+/.exec(init.headers?.range ?? '')?.[0] ?? 0) : 0;
    const all = content();
    if (from >= all.length && from > 0) return new Response(null, { status: 416 });
    return new Response(all.slice(from), { status: knowsRanges && init.headers ? 206 : 200 });
  });
}

for (const knowsRanges of [true, false])
  test(`a log is read on from its end${knowsRanges ? '' : ', without ranges, too'}`, async () => {
    const whole = new TextEncoder().encode('one\nzwölf\nthree\n');
    let length = 6; // in the middle of the ö
    serve(() => whole.slice(0, length), knowsRanges);
    const tail = new LogTail('/log');
    expect(await tail.read()).toBe('one\nzw');
    expect(await tail.read()).toBe('');
    length = 7;
    expect(await tail.read()).toBe('');
    length = whole.length;
    expect(await tail.read()).toBe('ölf\nthree\n');
    expect(await tail.read()).toBe('');
  });

test('an empty log is no error', async () => {
  serve(() => new Uint8Array());
  expect(await new LogTail('/log').read()).toBe('');
});

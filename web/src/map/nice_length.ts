/** The longest of 1, 2, 5, 10, 20 ... that is no longer than `longest`, for scale bars. */
export function niceLength(longest: number): number {
  const power = 10 ** Math.floor(Math.log10(longest));
  const factor = [5, 2, 1].find((candidate) => candidate * power <= longest) ?? 1;
  return Number((factor * power).toPrecision(1));
}

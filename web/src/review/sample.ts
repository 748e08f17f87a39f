/** A few of many, spread over all, the same for whoever asks: two reviewers can talk about the third. */
export function sampleOf(ids: string[], count: number): string[] {
  return ids
    .map((id) => ({ id, rank: hashOf(id) }))
    .sort((a, b) => a.rank - b.rank || a.id.localeCompare(b.id))
    .slice(0, count)
    .map(({ id }) => id);
}

/** FNV-1a, mixed once more: names that differ in their last letter only must not stay neighbors. */
function hashOf(text: string): number {
  let hash = 0x811c9dc5;
  for (const letter of text) hash = Math.imul(hash ^ letter.codePointAt(0)!, 0x01000193);
  return Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d) >>> 0;
}

// What an address asks to compare, where it says so; else what is most useful.

export interface Version {
  version: number;
  files_deleted_at: string | null;
}

/** The two versions, whose files must be there; the last two where the address does not say. Null: there are no two. */
export function versionsAsked(versions: readonly Version[], from: string | null, to: string | null): { from: number; to: number } | null {
  const there = versions.filter(({ files_deleted_at }) => files_deleted_at === null).map(({ version }) => version).sort((a, b) => b - a);
  if (there.length === 0) return null;
  const numberOf = (asked: string | null): number | null => {
    if (asked === 'latest') return there[0]!;
    return asked !== null && /^\d+$/.test(asked) ? Number(asked) : null;
  };
  const later = numberOf(to) ?? there.find((version) => version !== numberOf(from)) ?? null;
  const earlier = numberOf(from) ?? there.find((version) => later !== null && version < later) ?? there.find((version) => version !== later) ?? null;
  return earlier === null || later === null || earlier === later ? null : { from: earlier, to: later };
}

/** The two drives, by name. Null: there are no two. */
export function sessionsAsked(drives: readonly string[], from: string | null, to: string | null): { from: string; to: string } | null {
  const known = (asked: string | null) => (asked !== null && drives.includes(asked) ? asked : null);
  const later = known(to) ?? drives.findLast((drive) => drive !== known(from)) ?? null;
  const earlier = known(from) ?? drives.find((drive) => drive !== later) ?? null;
  return earlier === null || later === null || earlier === later ? null : { from: earlier, to: later };
}

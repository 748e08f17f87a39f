// Access tokens in words: what each role may, what still lets somebody in, and what goes with a token.

import type { Caller } from '../api/session';
import type { Schemas } from '../api/client';
import { sayWhen } from '../ui/when';

export type Token = Schemas['Token'];
export type Role = Schemas['Role'];

export const kRoles: { role: Role; about: string }[] = [
  { role: 'viewer', about: 'sees maps, drives and reviews; changes nothing' },
  { role: 'uploader', about: 'sees all, uploads drives, and deletes, stops and repeats what it uploaded itself: for cars and scripts' },
  { role: 'reviewer', about: 'sees all, builds, judges and shares maps; uploads nothing' },
  { role: 'admin', about: 'does everything, gives tokens, reads the audit log' },
];

export const kLifetimes: { days: number | null; text: string }[] = [
  { days: 7, text: '7 days' },
  { days: 30, text: '30 days' },
  { days: 90, text: '90 days' },
  { days: 365, text: '1 year' },
  { days: null, text: 'no end' },
];

/** What ends by itself or by somebody: a token, or a link. */
interface Ending {
  expires_at: string | null;
  revoked_at: string | null;
}

export type Life = 'works' | 'revoked' | 'ended';

export function lifeOf({ expires_at, revoked_at }: Ending, now = Date.now()): Life {
  if (revoked_at !== null) return 'revoked';
  return expires_at !== null && Date.parse(expires_at) <= now ? 'ended' : 'works';
}

/** "no end", "ends in 3 days", "ended 5 days ago", "revoked 2 h ago". */
export function sayEnd(ending: Ending, now = Date.now()): string {
  const life = lifeOf(ending, now);
  if (life === 'revoked') return `revoked ${sayWhen(ending.revoked_at!, now)}`;
  if (ending.expires_at === null) return 'no end';
  return `${life === 'ended' ? 'ended' : 'ends'} ${sayWhen(ending.expires_at, now)}`;
}

export const saySites = (sites: readonly string[] | null) => (sites === null ? 'all sites' : sites.join(', '));

/** Names of sites in a text, by commas or blanks. */
export const namesIn = (text: string) => text.split(/[\s,]+/).filter((name) => name !== '');

/** What somebody should know before a token is revoked. */
export function warningsOf(token: Token, all: readonly Token[], caller: Pick<Caller, 'name'> | null, now = Date.now()): string[] {
  const isAdminOfAll = (one: Token) => one.role === 'admin' && one.sites === null && lifeOf(one, now) === 'works';
  const warnings: string[] = [];
  if (isAdminOfAll(token) && all.filter(isAdminOfAll).length === 1)
    warnings.push('It is the last admin token for all sites: new tokens can then only be made on the machine, by "parkade token create".');
  if (token.name === caller?.name) warnings.push('It has the name that you are signed in by: if it is yours, you are signed out with it.');
  return warnings;
}

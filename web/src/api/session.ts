// Who uses the page. Without tokens everybody may do everything; from the first token on, a token or
// a share link is exchanged for a session, whose cookie no script sees.

import { request, setCsrfToken, type Schemas } from './client';
import { offerEvents } from './events';

export type Caller = Schemas['Caller'];
export type Role = Caller['role'];

function keep(session: Schemas['Session']): Schemas['Session'] {
  setCsrfToken(session.csrf);
  offerEvents(session.caller !== null && seesDrives(session.caller));
  return session;
}

export const fetchSession = async () => keep(await request('get', '/api/v1/session'));
export const signIn = async (token: string) => keep(await request('post', '/api/v1/session', { body: { token } }));
/** A session that has ended already is one to leave, too. */
export const signOut = () => request('delete', '/api/v1/session').catch(() => undefined);

/** The secret of a share link, behind the address's '#', where no server sees it. */
export function shareIn(hash: string): string | null {
  return /^#share=(parkade_share_[A-Za-z0-9_-]+)$/.exec(hash)?.[1] ?? null;
}

export const mayUpload = (caller: Caller) => caller.role === 'uploader' || caller.role === 'admin';
export const mayReview = (caller: Caller) => caller.role === 'reviewer' || caller.role === 'admin';
export const seesDrives = (caller: Caller) => caller.role !== 'link';

// Who uses the page. Without tokens everybody may do everything; from the first token on, a token or
// a share link is exchanged for a session, whose cookie no script sees.

export type Role = 'viewer' | 'uploader' | 'reviewer' | 'admin' | 'link';

export interface Caller {
  name: string;
  role: Role;
  sites: string[] | null; // null: all
  version: number | null;
  pictures: boolean;
}

export interface Session {
  access: 'open' | 'token';
  caller: Caller | null; // nobody yet
  csrf: string | null;
}

const PATH = '/api/v1/session';
let current: Session = { access: 'open', caller: null, csrf: null };

async function ask(method: string, body?: object): Promise<Session> {
  const headers: Record<string, string> = { accept: 'application/json', ...changeHeaders() };
  if (body) headers['content-type'] = 'application/json';
  const response = await fetch(PATH, { method, headers, ...(body ? { body: JSON.stringify(body) } : {}) });
  if (!response.ok) {
    const problem = (await response.json().catch(() => ({}))) as { detail?: string };
    throw new Error(problem.detail ?? `the service answered ${response.status}`);
  }
  current = (await response.json()) as Session;
  return current;
}

/** What every request that changes something carries. */
export function changeHeaders(): Record<string, string> {
  return current.csrf ? { 'x-csrf-token': current.csrf } : {};
}

export const fetchSession = () => ask('GET');
export const signIn = (token: string) => ask('POST', { token });

export async function signOut(): Promise<void> {
  await fetch(PATH, { method: 'DELETE', headers: changeHeaders() });
}

/** The secret of a share link, behind the address's '#', where no server sees it. */
export function shareIn(hash: string): string | null {
  return /^#share=(parkade_share_[A-Za-z0-9_-]+)$/.exec(hash)?.[1] ?? null;
}

export const mayUpload = (caller: Caller) => caller.role === 'uploader' || caller.role === 'admin';
export const mayReview = (caller: Caller) => caller.role === 'reviewer' || caller.role === 'admin';
export const seesDrives = (caller: Caller) => caller.role !== 'link';

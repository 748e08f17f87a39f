// Who uses the page, for every part that shows less to some.

import { onSignedOut } from '../api/client';
import { fetchSession, mayReview, mayUpload, seesDrives, shareIn, signIn, signOut, type Caller } from '../api/session';

class CallerState {
  caller: Caller | null = $state.raw(null);
  /** open: nobody needs a token, and everybody may do everything. */
  access: 'open' | 'token' = $state('token');
  /** Whether the service has been asked yet. */
  isKnown = $state(false);
  /** Why nobody is signed in, where that needs words. */
  complaint = $state('');

  get mayUpload(): boolean {
    return this.caller !== null && mayUpload(this.caller);
  }
  get mayReview(): boolean {
    return this.caller !== null && mayReview(this.caller);
  }
  get seesDrives(): boolean {
    return this.caller !== null && seesDrives(this.caller);
  }
  get isAdmin(): boolean {
    return this.caller?.role === 'admin';
  }
  /** Tokens, webhooks and the audit log are of no site: an admin of some sites does not see them. */
  get isAdminOfAll(): boolean {
    return this.isAdmin && this.caller?.sites === null;
  }

  /** Asks who the browser's session belongs to; a share link in the address begins one. */
  async begin(): Promise<void> {
    const share = shareIn(location.hash);
    if (share) history.replaceState(null, '', location.pathname + location.search); // it is not for bookmarks
    try {
      const session = await fetchSession();
      this.access = session.access;
      this.caller = session.caller;
      // Whoever is signed in stays so: the link shows no more than that does.
      if (share && (!this.caller || this.caller.role === 'link'))
        this.caller = (await signIn(share).catch((error: Error) => this.refuse(error)))?.caller ?? null;
    } catch (error) {
      this.complaint = error instanceof Error ? error.message : String(error);
    }
    this.isKnown = true;
    onSignedOut(() => this.end());
  }

  async enter(token: string): Promise<void> {
    this.caller = (await signIn(token)).caller;
    this.complaint = '';
  }

  async leave(): Promise<void> {
    await signOut();
    location.assign('/');
  }

  /** The session ended meanwhile. Whoever signs in again is where they were. */
  private end(): void {
    if (!this.caller) return;
    this.complaint =
      this.access === 'open' ? 'From now on this service asks for a token.'
      : this.caller.role === 'link' ? 'This link has ended. Ask for a new one, or sign in by a token.'
      : 'Your session has ended. Sign in again to go on where you were.';
    this.access = 'token';
    this.caller = null;
  }

  private refuse(error: Error): null {
    this.complaint = `This link does not work: ${error.message}. Ask for a new one, or sign in by a token.`;
    return null;
  }
}

export const callerState = new CallerState();

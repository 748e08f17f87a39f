import { element } from './dom';
import { fetchSession, shareIn, signIn, signOut, type Caller } from './session';

/** Waits until somebody is known who may use the page. Asks for a token where one is needed. */
export async function awaitCaller(place: HTMLElement): Promise<Caller> {
  const share = shareIn(location.hash);
  if (share) {
    history.replaceState(null, '', location.pathname + location.search); // it is not for bookmarks
    const bySharing = await signIn(share).catch((error: Error) => error.message);
    if (typeof bySharing !== 'string' && bySharing.caller) return bySharing.caller;
    if (typeof bySharing === 'string') return askForToken(place, `This link does not work: ${bySharing}.`);
  }
  const session = await fetchSession();
  return session.caller ?? askForToken(place, '');
}

function askForToken(place: HTMLElement, why: string): Promise<Caller> {
  return new Promise((resolve) => {
    const input = element('input', { type: 'password', id: 'token', autocomplete: 'current-password', required: true });
    const said = element('p', { class: 'error', role: 'alert' }, why);
    const button = element('button', { type: 'submit' }, 'Sign in');
    const form = element(
      'form',
      { class: 'sign-in', 'aria-label': 'Sign in' },
      element('h2', {}, 'Sign in'),
      element('label', { for: 'token' }, 'Your token'),
      input,
      element('p', { class: 'hint' }, 'Whoever runs this service makes one for you: parkade token create'),
      said,
      button,
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      button.disabled = true;
      signIn(input.value.trim())
        .then(({ caller }) => {
          if (!caller) return;
          form.remove();
          resolve(caller);
        })
        .catch((error: Error) => {
          said.textContent = error.message;
          input.select();
        })
        .finally(() => (button.disabled = false));
    });
    place.append(form);
    input.focus();
  });
}

/** Who is signed in, and the way out. */
export function showCaller(place: HTMLElement, caller: Caller): void {
  const leave = element('button', { type: 'button', class: 'quiet' }, 'Sign out');
  leave.addEventListener('click', () => void signOut().then(() => location.reload()));
  place.append(element('span', { class: 'hint' }, `${caller.name} · ${caller.role}`), leave);
}

// Answers that are asked for before the scripts are there that need them: a picture of a map waits for both.

const answers = new Map<string, Promise<Response>>();

/** Asks at once. Whoever asks for the same address next gets this answer. */
export function askEarly(address: string): Promise<Response> {
  const answer = fetch(address);
  answer.catch(() => undefined); // whoever takes it sees the failure
  answers.set(address, answer);
  return answer.then((response) => response.clone());
}

/** The answer that was asked for early, once; undefined where there is none. Who has signed in since is answered anew. */
export function takeEarly(address: string, init?: RequestInit): Promise<Response> | undefined {
  if (answers.size === 0) return undefined;
  const { pathname, search } = new URL(address, location.href);
  const answer = answers.get(pathname + search);
  answers.delete(pathname + search);
  return answer?.then((response) => (response.status === 401 ? fetch(address, init) : response), () => fetch(address, init));
}

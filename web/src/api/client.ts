// Requests as server/http/openapi.json describes them: an address, a parameter or a body that is not
// in there does not compile. `npm run generate` makes schema.ts of it.

import { takeEarly } from './early';
import type { components, paths } from './schema';

export type Schemas = components['schemas'];

type Method = 'get' | 'put' | 'post' | 'patch' | 'delete';
type Path<M extends Method> = { [P in keyof paths]: paths[P] extends Record<M, object> ? P : never }[keyof paths];
type Operation<M extends Method, P extends Path<M>> = paths[P] extends Record<M, infer Described> ? Described : never;
type JsonOf<Content> = Content extends { content: { 'application/json': infer Json } } ? Json : never;

/** What an address is filled with. */
type Place<Described> = Described extends { parameters: { path?: object; query?: object } }
  ? Pick<Described['parameters'], 'path' | 'query'>
  : never;
type Body<Described> = Described extends { requestBody?: object }
  ? { [Key in keyof Pick<Described, 'requestBody'> as 'body']: JsonOf<Described[Key]> }
  : unknown;
/** It may be left out where nothing in it is required. */
type Argument<Input> = object extends Input ? [input?: Input] : [input: Input];

type Answers<Described> = Described extends { responses: infer All } ? All[keyof All & (200 | 201 | 202)] : never;
type OrNothing<Type> = [Type] extends [never] ? undefined : Type;
/** What a request is answered where it is not refused. */
type Answer<M extends Method, P extends Path<M>> = OrNothing<JsonOf<Answers<Operation<M, P>>>>;

interface AnyInput {
  path?: object;
  query?: object;
  body?: unknown;
}

function fill(path: string, { path: segments = {}, query = {} }: AnyInput): string {
  let address = path;
  for (const [name, value] of Object.entries(segments)) {
    const segment = encodeURIComponent(String(value));
    address = address.replace(`{${name}}`, name === 'file' ? segment.replaceAll('%2F', '/') : segment); // it lies in a folder
  }
  const said = Object.entries(query).filter(([, value]) => value !== undefined);
  return said.length === 0 ? address : `${address}?${new URLSearchParams(said.map(([name, value]) => [name, String(value)]))}`;
}

/** The address of a request, for links and for what fetch cannot do. */
export function addressOf<M extends Method, P extends Path<M>>(
  _method: M,
  path: P,
  ...[input]: Argument<Place<Operation<M, P>>>
): string {
  return fill(path, input ?? {});
}

/** Sends a request. Throws an Error with one sentence where it is refused. */
export async function request<M extends Method, P extends Path<M>>(
  method: M,
  path: P,
  ...[input]: Argument<Place<Operation<M, P>> & Body<Operation<M, P>>>
): Promise<Answer<M, P>> {
  const { body, ...place }: AnyInput = input ?? {};
  const answer = await fetchJson(fill(path, place), {
    method: method.toUpperCase(),
    headers: {
      accept: 'application/json',
      ...(method === 'get' ? {} : changeHeaders()),
      ...(body === undefined ? {} : { 'content-type': 'application/json' }),
    },
    ...(body === undefined ? {} : { body: JSON.stringify(body) }),
  });
  return answer as Answer<M, P>; // the service's tests hold its answers against the description
}

/** What an address answers; nothing where that is empty. */
export async function fetchJson(address: string, init?: RequestInit): Promise<unknown> {
  const early = (init?.method ?? 'GET') === 'GET' ? takeEarly(address, init) : undefined;
  const response = await (early ?? fetch(address, init)).catch(() => {
    throw new Error('the service does not answer');
  });
  const text = await response.text();
  if (response.status === 401) tellSignedOut();
  if (!response.ok) throw new Error(refusalIn(text, response.status));
  return text === '' ? undefined : JSON.parse(text);
}

/** Why a request was refused, in one sentence for people: RFC 9457's `detail`. */
export function refusalIn(text: string, status: number): string {
  const unexplained = `the service answered ${status}`;
  try {
    const problem = JSON.parse(text) as Partial<Schemas['Problem']> | null;
    return problem?.detail ?? problem?.title ?? unexplained;
  } catch {
    return unexplained; // a proxy's page
  }
}

let tellSignedOut = () => {};

/** Who is told when the service asks for a token: the session has ended, or was ended. */
export function onSignedOut(listener: () => void): void {
  tellSignedOut = listener;
}

let csrfToken: string | null = null;

/** The session's token, without which its changes are refused; null without a session. */
export function setCsrfToken(token: string | null): void {
  csrfToken = token;
}

/** What every request that changes something carries. */
export function changeHeaders(): Record<string, string> {
  return csrfToken ? { 'x-csrf-token': csrfToken } : {};
}

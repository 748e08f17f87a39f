// Whether the service still knows something that was begun.

type Answer<Known> = { is: 'known'; value: Known } | { is: 'gone' } | { is: 'silent' };

/** Only what the service surely does not know may be forgotten: not what it could not be asked for. */
export async function ask<Known>(address: string): Promise<Answer<Known>> {
  const response = await fetch(address, { headers: { accept: 'application/json' } }).catch(() => null);
  if (response?.status === 404) return { is: 'gone' };
  return response?.ok ? { is: 'known', value: (await response.json()) as Known } : { is: 'silent' };
}

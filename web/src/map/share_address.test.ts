import { expect, test } from 'vitest';

import { shareIn } from '../api/session';
import { shareAddress, viewAddress } from './share_address';

const shown = {
  site: 'lot',
  version: 2,
  query: new URLSearchParams('tab=share&layers=ground,slots&chosen=comment:7&drive=d1&t=3.20&view=1,1,1,0,0,0'),
  view: { position: [1, -20, 30] as [number, number, number], target: [1, 2, 0] as [number, number, number] },
};

test('the address of a view holds the version and the camera of now', () => {
  const address = new URL(viewAddress('http://host', shown));
  expect(address.pathname).toBe('/sites/lot/maps/2');
  expect(address.searchParams.get('view')).toBe('1.00,-20.00,30.00,1.00,2.00,0.00');
  expect(address.searchParams.get('t')).toBe('3.20');
  expect(viewAddress('http://host', { ...shown, query: new URLSearchParams(), view: null })).toBe('http://host/sites/lot/maps/2');
});

test('the address of a share link carries its secret where the page finds it, and nothing of drives', () => {
  const secret = 'parkade_share_a-b_c';
  const ofVersion = new URL(shareAddress('http://host', secret, shown, true));
  expect(shareIn(ofVersion.hash)).toBe(secret);
  expect([...ofVersion.searchParams.keys()]).toEqual(['layers', 'view']);
  expect(shareAddress('http://host', secret, shown, false)).toBe(`http://host/sites/lot#share=${secret}`);
});

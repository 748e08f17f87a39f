import { afterEach, expect, test, vi } from 'vitest';

import { fetchViews } from './views';

afterEach(() => vi.unstubAllGlobals());

test('the best of all drives comes first, and a drive without its log does not take the others away', async () => {
  const view = (camera: string, resolution: number) => ({
    camera, resolution, time: '1.000000000', pixel: [1, 2], distance: 3, view_angle: 0, url: `/${camera}`,
  });
  const asked: string[] = [];
  vi.stubGlobal('fetch', (address: string) => {
    asked.push(address);
    if (address.includes('/gone/')) return Promise.resolve(new Response('{"detail":"its log was deleted"}', { status: 409 }));
    const views = address.includes('/first/') ? [view('cam0', 90), view('cam1', 10)] : [view('cam2', 50)];
    return Promise.resolve(new Response(JSON.stringify({ views })));
  });
  const drives = ['first', 'second', 'gone'].map((id) => ({ id, name: `${id} drive`, color: 0 }));
  const { views, complaints } = await fetchViews({ drives, map: { version: 7 } as never }, [1, 2.00049, -0.5]);
  expect(views.map(({ camera, drive }) => [drive, camera])).toEqual([['first', 'cam0'], ['second', 'cam2'], ['first', 'cam1']]);
  expect(complaints).toEqual([{ drive: 'gone drive', reason: 'its log was deleted' }]);
  expect(new URL(asked[0]!, 'http://page').searchParams.get('point')).toBe('1.000,2.000,-0.500');
  expect(new URL(asked[0]!, 'http://page').searchParams.get('version')).toBe('7');
});

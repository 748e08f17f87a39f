// Ground of a map to click on: not every pixel of a picture is ground, but where a car drove there is some.

const kHeight = 0.5; // [m] of the trajectory above the ground, about

/** A point of the ground, [m] in site: below the middle of the first drive. */
export async function groundPoint({ address, site }) {
  const version = `${address}/api/v1/sites/${site.name}/maps/${site.latest_version}`;
  const { drives } = await (await fetch(version)).json();
  const lines = (await (await fetch(`${version}/${drives[0].name}/trajectory.tum`)).text()).split('\n').filter((line) => line !== '' && !line.startsWith('#'));
  const [x, y, z] = lines[Math.floor(lines.length / 2)].split(' ').slice(1, 4).map(Number);
  return [x, y, z - kHeight];
}

/** For the address: from nearly straight above it. */
export async function viewOfGround(world) {
  const [x, y, z] = await groundPoint(world);
  return [x, y - 1, z + 14, x, y, z].map((value) => value.toFixed(2)).join(',');
}

const kPlaces = [[0.5, 0.5], [0.52, 0.48], [0.48, 0.52], [0.52, 0.52], [0.48, 0.48]];

/** Clicks until one hits: `isHit` answers something true then. Returns where, [px] in the canvas. */
export async function clickGround(page, isHit, places = kPlaces) {
  const { width, height } = await page.locator('#canvas').boundingBox();
  for (const [x, y] of places) {
    const position = { x: x * width, y: y * height };
    await page.locator('#canvas').click({ position });
    for (let i = 0; i < 10; ++i) {
      if (await isHit()) return position;
      await page.waitForTimeout(100);
    }
  }
  throw new Error('no click hit the ground');
}

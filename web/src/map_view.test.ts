import * as THREE from 'three';
import { beforeEach, expect, test, vi } from 'vitest';

import { MapView } from './map_view';

// No canvas and no network here: what would draw does nothing, and what would load makes a map.
const loaded: THREE.Group[] = [];

vi.mock('three', async (original) => ({
  ...(await original<typeof THREE>()),
  WebGLRenderer: class {
    capabilities = { getMaxAnisotropy: () => 1 };
    setPixelRatio() {}
    setSize() {}
    render() {}
  },
}));
vi.mock('three/examples/jsm/controls/OrbitControls.js', () => ({
  OrbitControls: class {
    addEventListener() {}
  },
}));
vi.mock('three/examples/jsm/loaders/DRACOLoader.js', () => ({
  DRACO_GLTF_CONFIG: '',
  DRACOLoader: class {
    setDecoderPath() {}
  },
}));
vi.mock('three/examples/jsm/loaders/GLTFLoader.js', () => ({
  GLTFLoader: class {
    setDRACOLoader() {}
    loadAsync() {
      return Promise.resolve({ scene: makeMap() });
    }
  },
}));
vi.stubGlobal('window', { devicePixelRatio: 1 });
vi.stubGlobal('requestAnimationFrame', () => 0);
vi.stubGlobal('ResizeObserver', class {
  observe() {}
});

function makeMap(): THREE.Group {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute([0, 0, 0, 1, 0, 0, 0, 1, -1], 3));
  const ground = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: new THREE.Texture() }));
  ground.name = 'ground';
  const trajectory = new THREE.Line(new THREE.BufferGeometry());
  trajectory.name = 'drive:a';
  const map = new THREE.Group().add(ground, trajectory);
  loaded.push(map);
  return map;
}

/** What the map that was loaded last shows. */
function look() {
  const map = loaded.at(-1)!;
  const ground = map.getObjectByName('ground') as THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  return {
    ground: ground.visible,
    trajectory: map.getObjectByName('drive:a')!.visible,
    isByHeight: ground.geometry.hasAttribute('color') && ground.material.map === null,
  };
}

let view: MapView;
beforeEach(() => {
  view = new MapView({ addEventListener() {}, clientWidth: 0, clientHeight: 0 } as unknown as HTMLCanvasElement);
});

test('a map looks as the toolbar says at first', async () => {
  await view.load('1.glb');

  expect(look()).toEqual({ ground: true, trajectory: true, isByHeight: false });
});

test('the next map is seen as the one before', async () => {
  await view.load('1.glb');
  view.setGroundVisible(false);
  view.setTrajectoriesVisible(false);
  view.setColorMode('height');
  await view.load('2.glb');
  expect(look()).toEqual({ ground: false, trajectory: false, isByHeight: true });

  view.setGroundVisible(true);
  view.setColorMode('photo');
  await view.load('3.glb');
  expect(look()).toEqual({ ground: true, trajectory: false, isByHeight: false });
});

// Sites on the Earth: a grid of longitudes and latitudes, perhaps a basemap, and the outline of each site.

import 'maplibre-gl/dist/maplibre-gl.css';

import type { Feature, FeatureCollection } from 'geojson';
import maplibregl, { type GeoJSONSource, type LayerSpecification, type StyleSpecification } from 'maplibre-gl';
import { PMTiles, Protocol } from 'pmtiles';

import { fetchCollection, fetchMap, type FreeSpaceProperties } from '../api/map_files';
import { faultOf, wordsOf, type Basemap } from './basemap';
import { degreesText, graticuleOf, stepFor } from './graticule';
import { boxOf, middleOf, outlineOf, type LonLat } from './site_outline';
import type { SiteRow } from './site_rows';

const kShapeZoom = 15.5; // from here on free space is told from its box
const kLabelGap = 6; // [px]
const kPatience = 1000; // [ms] after which a basemap without any tile is looked at
const kEmpty: FeatureCollection = { type: 'FeatureCollection', features: [] };

interface Place {
  row: SiteRow;
  outline: LonLat[];
  marker: maplibregl.Marker;
  element: HTMLAnchorElement;
}

export class OverviewMap {
  private readonly map: maplibregl.Map;
  private readonly places = new Map<string, Place>();
  private readonly shapes = new Map<string, Feature[]>(); // by site and version; empty while it is fetched
  private readonly ready: Promise<void>;
  private readonly gridLabels = document.createElement('div');
  private hasFitted = false;
  private isGone = false;
  private basemapWatch: ReturnType<typeof setInterval> | undefined;

  /** `hrefOf` is where a click on a site goes. */
  constructor(
    private readonly container: HTMLElement,
    private readonly hrefOf: (row: SiteRow) => string,
  ) {
    this.map = new maplibregl.Map({
      container,
      style: emptyStyle(),
      center: [0, 30],
      zoom: 1,
      maxZoom: 22,
      attributionControl: false,
      dragRotate: false,
      pitchWithRotate: false,
    });
    this.map.touchZoomRotate.disableRotation();
    this.map.addControl(new maplibregl.NavigationControl({ showCompass: false }), 'top-right');
    this.map.addControl(new maplibregl.ScaleControl({ maxWidth: 120 }), 'bottom-left');
    this.gridLabels.className = 'grid-labels';
    this.gridLabels.ariaHidden = 'true';
    container.append(this.gridLabels);
    this.ready = new Promise((resolve) => this.map.once('load', () => resolve()));
    void this.ready.then(() => this.recolor());
    this.map.on('move', () => this.update());
    this.map.on('moveend', () => void this.fetchShapes());
    this.map.on('load', () => this.update());
  }

  /** Shows these sites; the view goes to all of them the first time. */
  async show(rows: readonly SiteRow[]): Promise<void> {
    await this.ready;
    const shown = new Set<string>();
    for (const row of rows) {
      const outline = outlineOf(row.site);
      if (!outline) continue;
      shown.add(row.site.name);
      this.place(row, outline);
    }
    for (const [name, { marker }] of this.places)
      if (!shown.has(name)) {
        marker.remove();
        this.places.delete(name);
      }
    this.drawSites();
    if (!this.hasFitted) this.fit();
    this.update();
    await this.fetchShapes();
    this.map.triggerRepaint();
    await new Promise<void>((resolve) => this.map.once('idle', () => resolve()));
  }

  /** Sets a site off from the others; null: none. */
  highlight(name: string | null): void {
    for (const [other, { element }] of this.places) element.classList.toggle('chosen', other === name);
    this.declutter();
  }

  /** Everything in view. */
  fit(): void {
    const box = boxOf([...this.places.values()].map(({ outline }) => outline));
    if (!box) return;
    this.hasFitted = true;
    this.map.fitBounds(box, { padding: 70, maxZoom: 18, duration: 0 });
  }

  /** `onfault` is told why nothing of it can be drawn, and "" once something is. */
  async addBasemap(basemap: Basemap, onfault: (fault: string) => void): Promise<void> {
    await this.ready;
    if (this.isGone) return;
    let { attribution } = basemap;
    if (basemap.kind === 'tiles') {
      this.map.addSource('basemap', { type: 'raster', tiles: [basemap.url], tileSize: 256, attribution });
      this.addBelow({ id: 'basemap', type: 'raster', source: 'basemap' });
    } else {
      const archive = new PMTiles(new URL(basemap.url, location.href).href);
      const protocol = new Protocol();
      protocol.add(archive);
      maplibregl.addProtocol('pmtiles', protocol.tile);
      const [header, metadata] = await Promise.all([archive.getHeader(), archive.getMetadata()]);
      if (this.isGone) return;
      attribution ||= wordsOf((metadata as { attribution?: unknown } | null)?.attribution);
      const url = `pmtiles://${archive.source.getKey()}`;
      const kVector = 1; // of tileType
      if (header.tileType === kVector) {
        this.map.addSource('basemap', { type: 'vector', url, attribution });
        for (const layer of vectorLayers(metadata)) this.addBelow(layer);
      } else {
        this.map.addSource('basemap', { type: 'raster', url, tileSize: 256, attribution });
        this.addBelow({ id: 'basemap', type: 'raster', source: 'basemap' });
      }
    }
    this.watchBasemap(onfault);
    if (attribution !== '') this.map.addControl(new maplibregl.AttributionControl({ compact: true }), 'bottom-right');
    this.recolor();
  }

  /** Tiles that are missing (404) are what it does not cover; where none comes at all, something is wrong. */
  private watchBasemap(onfault: (fault: string) => void): void {
    let fault = '';
    let isDrawn = false;
    let isAskedFor = false;
    this.map.on('error', (event) => {
      if ((event as { sourceId?: string }).sourceId === 'basemap') fault = faultOf(event.error as { status?: number });
      else console.error(event.error);
    });
    this.map.on('sourcedata', ({ sourceId, tile }: { sourceId?: string; tile?: unknown }) => {
      if (sourceId !== 'basemap' || !tile || isDrawn) return;
      isDrawn = true;
      this.container.dataset['basemap'] = 'drawn';
      this.map.setLayoutProperty('grid', 'visibility', 'none'); // it stands in for a basemap
      onfault('');
    });
    // A frame asks for the tiles that it lacks: before the first there are none to wait for.
    this.map.on('render', () => void (isAskedFor ||= this.map.getSource('basemap')?.loaded() ?? false));
    // No event says that none came, and without a tile no frame is drawn either.
    this.basemapWatch = setInterval(() => {
      if ((!isAskedFor && fault === '') || !this.map.areTilesLoaded()) return;
      clearInterval(this.basemapWatch);
      if (!isDrawn) onfault(fault || 'it has no tiles of this place');
      this.map.triggerRepaint();
    }, kPatience);
  }

  /** Takes the colors of the page's theme, which may have changed. */
  recolor(): void {
    const color = (name: string) => colorOf(this.container, name);
    const paints: [layer: string, property: string, value: string][] = [
      ['ground', 'background-color', color('--scene')],
      ['grid', 'line-color', color('--line')],
      ['boxes', 'fill-color', color('--accent')],
      ['box-edges', 'line-color', color('--accent')],
      ['shapes', 'fill-color', color('--accent')],
      ['shape-edges', 'line-color', color('--accent')],
      ['earth', 'fill-color', color('--panel')],
      ['water', 'fill-color', color('--accent-soft')],
      ['buildings', 'fill-color', color('--raised')],
      ['roads', 'line-color', color('--line')],
    ];
    for (const [layer, property, value] of paints)
      if (this.map.getLayer(layer)) this.map.setPaintProperty(layer, property, value);
  }

  dispose(): void {
    this.isGone = true;
    clearInterval(this.basemapWatch);
    this.map.remove();
    this.gridLabels.remove();
  }

  private addBelow(layer: LayerSpecification): void {
    this.map.addLayer(layer, 'grid');
  }

  private place(row: SiteRow, outline: LonLat[]): void {
    const { name } = row.site;
    const before = this.places.get(name);
    const element = before?.element ?? document.createElement('a');
    element.href = this.hrefOf(row);
    element.textContent = row.site.title || name;
    element.title = name;
    element.dataset['site'] = name;
    element.tabIndex = -1; // the list beside it has the same links
    const marker =
      before?.marker ??
      new maplibregl.Marker({ element: labelAround(element), anchor: 'left' }).setLngLat(middleOf(outline)).addTo(this.map);
    marker.setLngLat(middleOf(outline));
    this.places.set(name, { row, outline, marker, element });
  }

  /** What follows the view. */
  private update(): void {
    const view = this.map.getBounds();
    const box: [number, number, number, number] = [view.getWest(), view.getSouth(), view.getEast(), view.getNorth()];
    const lines = graticuleOf(box);
    this.source('grid')?.setData({
      type: 'FeatureCollection',
      features: lines.map(({ line }) => ({ type: 'Feature', properties: {}, geometry: { type: 'LineString', coordinates: line } })),
    });
    this.labelGrid(lines, stepFor(box[2] - box[0]));
    this.declutter();
  }

  private labelGrid(lines: ReturnType<typeof graticuleOf>, step: number): void {
    const { clientWidth: width, clientHeight: height } = this.container;
    const center = this.map.getCenter();
    const labels: HTMLElement[] = [];
    for (const { at, isMeridian } of lines) {
      const { x, y } = this.map.project(isMeridian ? [at, center.lat] : [center.lng, at]);
      if (isMeridian ? x < 40 || x > width - 60 : y < 24 || y > height - 50) continue;
      const label = document.createElement('span');
      label.textContent = degreesText(at, isMeridian, step);
      label.className = isMeridian ? 'meridian' : 'parallel';
      if (isMeridian) label.style.left = `${x}px`;
      else label.style.top = `${y}px`;
      labels.push(label);
    }
    this.gridLabels.replaceChildren(...labels);
  }

  /** Hides labels that would lie over others; their dots stay. The chosen one goes first. */
  private declutter(): void {
    const taken: { left: number; right: number; top: number; bottom: number }[] = [];
    const isChosen = ({ element }: Place) => element.classList.contains('chosen');
    for (const place of [...this.places.values()].sort((a, b) => Number(isChosen(b)) - Number(isChosen(a)))) {
      const { x, y } = this.map.project(place.marker.getLngLat());
      const width = 24 + 8 * (place.element.textContent?.length ?? 0);
      const label = { left: x - kLabelGap, right: x + width + kLabelGap, top: y - 14, bottom: y + 14 };
      const isFree = taken.every(({ left, right, top, bottom }) => label.left > right || label.right < left || label.top > bottom || label.bottom < top);
      place.element.classList.toggle('crowded', !isFree);
      if (isFree) taken.push(label);
    }
  }

  private drawSites(): void {
    const features = [...this.places.values()].filter(({ row }) => !this.isShaped(row)).map(({ outline }): Feature => ({
      type: 'Feature', properties: {}, geometry: { type: 'Polygon', coordinates: [outline] },
    }));
    this.source('boxes')?.setData({ type: 'FeatureCollection', features });
    this.source('shapes')?.setData({
      type: 'FeatureCollection',
      features: [...this.places.values()].flatMap(({ row }) => this.shapes.get(keyOf(row)) ?? []),
    });
  }

  private isShaped(row: SiteRow): boolean {
    return (this.shapes.get(keyOf(row))?.length ?? 0) > 0;
  }

  /** Fetches free space of the sites in view, once each. */
  private async fetchShapes(): Promise<void> {
    if (this.map.getZoom() < kShapeZoom) return;
    const view = this.map.getBounds();
    const wanted = [...this.places.values()].filter(
      ({ row, outline }) => row.site.latest_version !== null && !this.shapes.has(keyOf(row)) && outline.some((corner) => view.contains(corner)),
    );
    await Promise.all(wanted.map(({ row }) => this.fetchShape(row)));
    if (wanted.length > 0 && !this.isGone) this.drawSites(); // somebody may have gone elsewhere meanwhile
  }

  private async fetchShape(row: SiteRow): Promise<void> {
    this.shapes.set(keyOf(row), []);
    try {
      const map = await fetchMap(row.site.name, String(row.site.latest_version));
      const { features } = await fetchCollection<FreeSpaceProperties>(map, 'free_space.geojson');
      if (map.datum) this.shapes.set(keyOf(row), features as unknown as Feature[]); // as the service writes them
    } catch {
      // Its box stays: the files of this version may be deleted.
    }
  }

  private source(name: string): GeoJSONSource | undefined {
    return this.map.getSource<GeoJSONSource>(name);
  }
}

const keyOf = ({ site }: SiteRow) => `${site.name}/${site.latest_version}`;

function labelAround(link: HTMLAnchorElement): HTMLElement {
  const label = document.createElement('div');
  label.className = 'site-label';
  // MapLibre would make it a button, around a link.
  label.role = 'group';
  label.ariaLabel = `Site ${link.textContent}`;
  label.append(link);
  return label;
}

function emptyStyle(): StyleSpecification {
  const source = () => ({ type: 'geojson' as const, data: kEmpty });
  return {
    version: 8,
    sources: { grid: source(), boxes: source(), shapes: source() },
    layers: [
      { id: 'ground', type: 'background', paint: { 'background-color': 'transparent' } },
      { id: 'grid', type: 'line', source: 'grid', paint: { 'line-width': 1 } },
      { id: 'boxes', type: 'fill', source: 'boxes', paint: { 'fill-opacity': 0.15 } },
      { id: 'box-edges', type: 'line', source: 'boxes', paint: { 'line-width': 2 } },
      { id: 'shapes', type: 'fill', source: 'shapes', paint: { 'fill-opacity': 0.3 } },
      { id: 'shape-edges', type: 'line', source: 'shapes', paint: { 'line-width': 1.5 } },
    ],
  };
}

/** Plain layers of what a vector archive has, by the names of Protomaps and OpenMapTiles. */
function vectorLayers(metadata: unknown): LayerSpecification[] {
  const listed = (metadata as { vector_layers?: { id: string }[] } | null)?.vector_layers ?? [];
  const layers: LayerSpecification[] = [];
  const find = (...names: string[]) => names.find((name) => listed.some(({ id }) => id === name));
  const fill = (id: string, layer: string | undefined) =>
    layer && layers.push({ id, type: 'fill', source: 'basemap', 'source-layer': layer });
  fill('earth', find('earth', 'landcover'));
  fill('water', find('water'));
  fill('buildings', find('buildings', 'building'));
  const roads = find('roads', 'transportation');
  if (roads)
    layers.push({
      id: 'roads', type: 'line', source: 'basemap', 'source-layer': roads,
      paint: { 'line-width': ['interpolate', ['exponential', 1.6], ['zoom'], 8, 0.5, 18, 12] },
    });
  return layers;
}

/** A color of the page's theme, as WebGL can have it. */
function colorOf(place: HTMLElement, name: string): string {
  const probe = document.createElement('span');
  probe.style.color = `var(${name})`;
  place.append(probe);
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}

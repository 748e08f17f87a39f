// What the service answers, by the names that the page uses.

import type { Schemas } from './client';

export type Drive = Schemas['Drive'];
export type Site = Schemas['Site'];
export type Job = Schemas['Job'];
export type MapVersion = Schemas['Map'];
export type ListedMap = Schemas['ListedMap'];
export type Review = Schemas['Review'];
export type ReviewState = Schemas['ReviewState'];
export type Comment = Schemas['Comment'];
export type Measurement = Schemas['Measurement'];
export type Comparison = Schemas['Comparison'];
export type Plots = Schemas['Plots'];
export type Keyframes = Schemas['Keyframes'];
export type Pose = Schemas['Pose'];
export type Rig = Schemas['Rig'];
export type Datum = Schemas['Datum'];

/** [m] a point of the site: x, y, z, z up. */
export type Vector = [number, number, number];

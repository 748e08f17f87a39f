// What a first look at a log found, in words, before anything is mapped.

import type { Schemas } from '../api/client';
import { secondsBetween } from '../api/map_files';
import { formatDuration } from '../ui/format';

export type Inspection = Schemas['Inspection'];
type Topic = Schemas['InspectedTopic'];

/** One finding: "bad" keeps the drive from being mapped, "warn" costs quality, "good" is as it should be. */
export interface Finding {
  kind: 'bad' | 'warn' | 'good';
  text: string;
}

/** What the state of an inspection means for who reads it. */
export function verdictOf(state: Inspection['state']): string {
  switch (state) {
    case 'clean': return 'Nothing is wrong with this log.';
    case 'lossy': return 'This log can be mapped, but something of it is lost.';
    case 'unusable': return 'This log cannot be mapped.';
  }
}

/** What was found, worst first. */
export function findingsOf(inspection: Inspection): Finding[] {
  const bad = inspection.missing.map((text): Finding => ({ kind: 'bad', text: sentence(text) }));
  const warn = [
    ...damageWords(inspection),
    ...inspection.topics.flatMap((topic) => topicWords(topic, inspection.begin)),
    ...inspection.warnings.map(sentence),
  ].map((text): Finding => ({ kind: 'warn', text }));
  return [...bad, ...warn, { kind: 'good', text: contentWords(inspection) }];
}

function contentWords({ duration_s, rig, topics }: Inspection): string {
  const messages = topics.reduce((sum, topic) => sum + topic.messages, 0);
  const what = `${formatDuration(duration_s)} with ${counted(messages, 'message')} of ${counted(topics.length, 'stream')}`;
  if (!rig) return `${what}.`;
  const body = rig.has_body_frame ? '' : ', without the frame of the body (wheels are not used)';
  return `${what}; its rig has ${counted(rig.cameras.length, 'camera')} and an IMU${body}.`;
}

function damageWords({ damage }: Inspection): string[] {
  const words: string[] = [];
  if (damage.is_truncated) words.push('The recording was cut off: its end is missing.');
  if (damage.lost_messages > 0)
    words.push(`${counted(damage.lost_messages, 'message')} cannot be read, in ${counted(damage.ranges.length, 'damaged place')} of the file.`);
  return words;
}

const kFaults: Record<string, string> = {
  dark: 'shows next to nothing, it is too dark',
  unchanged: 'shows the same image over and over: the camera or its driver hung',
  covered: 'is partly covered, by dirt or something else on the lens',
};

function topicWords(topic: Topic, begin: string | undefined): string[] {
  const words: string[] = [];
  const at = (time: string) => (begin === undefined ? '' : ` ${formatDuration(secondsBetween(begin, time))} after the start`);
  const longest = topic.gaps.reduce<(typeof topic.gaps)[number] | null>((most, gap) => (most && most.seconds >= gap.seconds ? most : gap), null);
  if (longest)
    words.push(
      topic.gaps.length === 1
        ? `${topic.topic} has a gap of ${longest.seconds.toFixed(1)} s${at(longest.begin)}.`
        : `${topic.topic} has ${topic.gaps.length} gaps; the longest is ${longest.seconds.toFixed(1)} s${at(longest.begin)}.`,
    );
  const dropped: [number, string][] = [
    [topic.damaged, 'cannot be decoded'],
    [topic.implausible, 'hold values that cannot be'],
    [topic.without_stamp, 'have no time stamp'],
    [topic.backward, 'have times that go back'],
    [topic.repeated, 'repeat the one before'],
    [topic.other_sizes, 'have another image size than the rig says'],
  ];
  for (const [count, what] of dropped)
    if (count > 0) words.push(`${topic.topic}: ${count.toLocaleString('en')} of ${counted(topic.messages, 'message')} ${what}.`);
  for (const fault of topic.picture_faults ?? []) {
    const duration = formatDuration(Math.max(1, secondsBetween(fault.begin, fault.end)));
    words.push(`${topic.topic} ${kFaults[fault.kind] ?? fault.kind}, for ${duration}${at(fault.begin)}.`);
  }
  return words;
}

export function counted(count: number, what: string): string {
  return `${count.toLocaleString('en')} ${what}${count === 1 ? '' : 's'}`;
}

/** With a capital letter and a full stop. */
export function sentence(text: string): string {
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(begun) ? begun : `${begun}.`;
}

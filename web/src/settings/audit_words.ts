// Entries of the audit log in words, and where what they tell of is found.

import type { Schemas } from '../api/client';
import { pathOf } from '../shell/routes';
import { sayTime } from '../ui/when';

export type AuditEntry = Schemas['AuditEntry'];

const kDeeds: Record<string, string> = {
  'drive.create': 'uploaded a drive',
  'drive.delete': 'deleted a drive',
  'upload.create': 'began an upload',
  'upload.delete': 'dropped an upload',
  'upload_set.create': 'began an upload of several files',
  'upload_set.delete': 'dropped an upload of several files',
  'log.expire': 'deleted a log that the site keeps no longer',
  'rig.put': 'stored a rig',
  'job.create': 'ordered a map',
  'job.cancel': 'cancelled a job',
  'job.retry': 'repeated a job',
  'map.publish': 'published a map',
  'map.review': 'judged a map',
  'map.expire': 'deleted the files of a map that the site keeps no longer',
  'site.change': 'changed a site',
  'checklist.tick': 'ticked an item of a checklist',
  'checklist.untick': 'took a tick of a checklist away',
  'comment.create': 'wrote a comment',
  'comment.change': 'changed a comment',
  'comment.delete': 'deleted a comment',
  'measurement.create': 'saved a measurement',
  'measurement.delete': 'deleted a measurement',
  'pictures.see': 'looked at camera pictures of a drive',
  'session.begin': 'signed in',
  'session.end': 'signed out',
  'token.create': 'made a token',
  'token.revoke': 'revoked a token',
  'share.create': 'made a share link',
  'share.revoke': 'revoked a share link',
  'webhook.create': 'added a webhook',
  'webhook.delete': 'deleted a webhook',
};

/** What was done; the program's word where a newer service knows more than this page. */
export const deedOf = ({ action }: Pick<AuditEntry, 'action'>) => kDeeds[action] ?? action;

/** What an entry adds, in one line: "site: lot, version: 2". */
export function detailOf({ detail }: Pick<AuditEntry, 'detail'>): string {
  return Object.entries((detail ?? {}) as Record<string, unknown>)
    .filter(([, value]) => value !== null && value !== '')
    .map(([name, value]) => `${name.replaceAll('_', ' ')}: ${typeof value === 'string' ? said(value) : JSON.stringify(value)}`)
    .join(', ');
}

function said(text: string): string {
  if (/^[0-9a-f]{64}$/.test(text)) return `${text.slice(0, 12)}…`; // hashes are told apart by their beginnings
  if (/^\d{4}-\d\d-\d\dT[\d:.]+Z$/.test(text)) return sayTime(text);
  return text === 'in_review' ? 'in review' : text;
}

/** Where the subject of an entry is shown; null where it has no place of its own. */
export function placeOf({ action, subject }: Pick<AuditEntry, 'action' | 'subject'>): string | null {
  const [kind] = action.split('.');
  if (action === 'drive.delete') return null;
  if (kind === 'drive' || kind === 'pictures' || kind === 'log') return pathOf({ name: 'drive', drive: subject });
  if (kind === 'job') return pathOf({ name: 'job', job: subject });
  if (kind === 'rig') return pathOf({ name: 'rig', rig: subject });
  if (kind === 'site') return pathOf({ name: 'site', site: subject });
  const [site, version] = subject.split('/');
  return (kind === 'map' || kind === 'checklist') && site && version ? pathOf({ name: 'map', site, version }) : null;
}

/** Whether an entry has all of these words, anywhere. */
export function hasWords(entry: AuditEntry, words: string): boolean {
  const text = [entry.caller.name, entry.action, deedOf(entry), entry.subject, entry.address ?? '', detailOf(entry), entry.at]
    .join(' ')
    .toLowerCase();
  return words.toLowerCase().split(/\s+/).every((word) => text.includes(word));
}

// What may be decided about a version, by its state, in the service's words and in people's.

import type { Review, ReviewState } from '../api/types';

export type Action = Review['history'][number]['action'];

export interface Decision {
  action: Action;
  title: string; // of its button
  question: string; // of its dialog
  about: string;
  key: string;
  needsReason: boolean;
  look: 'primary' | 'danger' | '';
}

const kDecisions: Record<Action, Decision> = {
  submit: {
    action: 'submit', title: 'Submit', question: 'Submit for review?', key: 'S', needsReason: false, look: 'primary',
    about: 'The version then awaits its reviewers.',
  },
  approve: {
    action: 'approve', title: 'Approve', question: 'Approve this version?', key: 'A', needsReason: false, look: 'primary',
    about: 'It becomes the approved version of its site: cars that ask for that are steered by it.',
  },
  reject: {
    action: 'reject', title: 'Reject', question: 'Reject this version?', key: 'X', needsReason: true, look: 'danger',
    about: 'No car is to use it. The reason tells whoever makes the next version what to mend.',
  },
  reopen: {
    action: 'reopen', title: 'Reopen', question: 'Open the review again?', key: 'O', needsReason: false, look: '',
    about: 'The version is in review again; until it is approved anew, no car is to use it.',
  },
  comment: {
    action: 'comment', title: 'Remark', question: 'A remark for the history', key: 'H', needsReason: true, look: '',
    about: 'It stays in the history for good and changes nothing.',
  },
};

const kAllowed: Record<ReviewState, Action[]> = {
  draft: ['submit'],
  in_review: ['approve', 'reject'],
  approved: ['reopen', 'reject'],
  rejected: ['reopen'],
};

/** In the order of their buttons; a remark always fits. */
export const decisionsFor = (state: ReviewState): Decision[] => [...kAllowed[state], 'comment' as const].map((action) => kDecisions[action]);

/** What a state means to whoever sees it. */
export const kMeaning: Record<ReviewState, string> = {
  draft: 'Nobody was asked to look at it yet.',
  in_review: 'It awaits a decision.',
  approved: 'Cars may be steered by it.',
  rejected: 'No car is to use it.',
};

export const kDone: Record<Action, string> = {
  submit: 'submitted it for review',
  approve: 'approved it',
  reject: 'rejected it',
  reopen: 'opened the review again',
  comment: 'remarked',
};

#pragma once

#include <vector>

namespace parkade {

/// The migration that brings reviews, comments, measurements, settings of sites, retention and
/// webhooks. A published entry never changes: see schema.cpp.
inline const std::vector<const char*> kReviewSchema = {
    // Versions that were there before are drafts: nobody has looked at them.
    R"(ALTER TABLE maps ADD COLUMN review_state TEXT NOT NULL DEFAULT 'draft'
         CHECK (review_state IN ('draft', 'in_review', 'approved', 'rejected')))",
    // When its files were deleted, and when a drive's log was; NULL: they are stored.
    "ALTER TABLE maps ADD COLUMN files_deleted_at TEXT",
    "ALTER TABLE drives ADD COLUMN log_deleted_at TEXT",

    "ALTER TABLE sites ADD COLUMN title TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE sites ADD COLUMN note TEXT NOT NULL DEFAULT ''",
    // Days that raw logs and maps are kept; NULL: for ever.
    "ALTER TABLE sites ADD COLUMN log_days INTEGER",
    "ALTER TABLE sites ADD COLUMN map_days INTEGER",
    "ALTER TABLE sites ADD COLUMN default_rig TEXT",

    R"(CREATE TABLE reviews (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         map TEXT NOT NULL REFERENCES maps (id),
         action TEXT NOT NULL,
         from_state TEXT NOT NULL,
         to_state TEXT NOT NULL,
         comment TEXT NOT NULL,
         author TEXT NOT NULL,
         created_at TEXT NOT NULL) STRICT)",
    "CREATE INDEX reviews_by_map ON reviews (map, sequence)",

    // `thread` is the first comment of the thread that one answers to; NULL: it is the first.
    R"(CREATE TABLE comments (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         map TEXT NOT NULL REFERENCES maps (id),
         thread TEXT REFERENCES comments (id),
         text TEXT NOT NULL,
         pin TEXT,
         author TEXT NOT NULL,
         created_at TEXT NOT NULL,
         edited_at TEXT,
         resolved_at TEXT,
         resolved_by TEXT,
         deleted_at TEXT) STRICT)",
    "CREATE INDEX comments_by_map ON comments (map, sequence)",
    "CREATE INDEX comments_by_thread ON comments (thread, sequence)",

    R"(CREATE TABLE measurements (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         site TEXT NOT NULL REFERENCES sites (name),
         version INTEGER NOT NULL,
         kind TEXT NOT NULL CHECK (kind IN ('distance', 'area', 'height', 'slope', 'section')),
         title TEXT NOT NULL,
         points TEXT NOT NULL,
         author TEXT NOT NULL,
         created_at TEXT NOT NULL,
         FOREIGN KEY (site, version) REFERENCES maps (site, version)) STRICT)",
    "CREATE INDEX measurements_by_site ON measurements (site, sequence)",

    R"(CREATE TABLE webhooks (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         url TEXT NOT NULL,
         events TEXT NOT NULL,
         site TEXT,
         secret TEXT NOT NULL,
         author TEXT NOT NULL,
         created_at TEXT NOT NULL) STRICT)",

    // What is to be sent and what was sent: written in the transaction of the change it tells of.
    R"(CREATE TABLE deliveries (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         webhook TEXT NOT NULL REFERENCES webhooks (id) ON DELETE CASCADE,
         event TEXT NOT NULL,
         body TEXT NOT NULL,
         state TEXT NOT NULL DEFAULT 'waiting' CHECK (state IN ('waiting', 'delivered', 'failed')),
         attempts INTEGER NOT NULL DEFAULT 0,
         due_at TEXT NOT NULL,
         status INTEGER,
         duration_ms INTEGER,
         error TEXT,
         created_at TEXT NOT NULL,
         finished_at TEXT) STRICT)",
    "CREATE INDEX deliveries_by_state ON deliveries (state, due_at)",
    "CREATE INDEX deliveries_by_webhook ON deliveries (webhook, sequence)"};

}  // namespace parkade

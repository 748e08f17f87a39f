#include "server/store/tables/database.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/error.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

std::string Pragma(Database& database, const std::string& name) {
  return database.Read([&](Connection& connection) {
    Statement query = connection.Query("PRAGMA " + name);
    return query.Step() ? query.Text(0) : "";
  });
}

std::int64_t CountSites(Database& database) {
  return database.Read([](Connection& connection) {
    Statement query = connection.Query("SELECT count(*) FROM sites");
    query.Step();
    return query.Integer(0);
  });
}

void AddSite(Connection& connection, const std::string& name) {
  connection.Execute("INSERT INTO sites (name, created_at) VALUES (?, ?)", name, "now");
}

TEST(Database, SurvivesPowerCutsByItsSettings) {
  const TemporaryRoot root;
  Database database(root.path() / "main.db");

  EXPECT_EQ(Pragma(database, "journal_mode"), "wal");
  EXPECT_EQ(Pragma(database, "synchronous"), "2");  // FULL
  EXPECT_EQ(Pragma(database, "foreign_keys"), "1");
}

TEST(Database, KeepsWhatWasWritten) {
  const TemporaryRoot root;
  {
    Database database(root.path() / "main.db");
    database.Write([](Connection& connection) { AddSite(connection, "lot"); });
  }
  Database database(root.path() / "main.db");

  EXPECT_EQ(CountSites(database), 1);
}

TEST(Database, UndoesATransactionThatThrows) {
  const TemporaryRoot root;
  Database database(root.path() / "main.db");

  EXPECT_THROW(database.Write([](Connection& connection) {
    AddSite(connection, "lot");
    throw Error(ErrorCode::kConflict, "no");
  }),
               Error);

  EXPECT_EQ(CountSites(database), 0);
  database.Write([](Connection& connection) { AddSite(connection, "lot"); });
  EXPECT_EQ(CountSites(database), 1);
}

TEST(Database, RefusesAValueOfTheWrongTypeAndADanglingReference) {
  const TemporaryRoot root;
  Database database(root.path() / "main.db");

  const auto insert_job = [&](const std::string& site) {
    database.Write([&](Connection& connection) {
      connection.Execute(
          "INSERT INTO jobs (id, site, state, created_at) VALUES ('a', ?, 'queued', 'now')", site);
    });
  };
  EXPECT_THROW(insert_job("nowhere"), Error);
  EXPECT_THROW(database.Write([](Connection& connection) {
    connection.Execute(
        "INSERT INTO sites (sequence, name, created_at) VALUES ('one', 'lot', 'now')");
  }),
               Error);
}

TEST(Database, RefusesASchemaOfTheFuture) {
  const TemporaryRoot root;
  {
    Database database(root.path() / "main.db");
    database.Write([](Connection& connection) { connection.Execute("PRAGMA user_version=999"); });
  }
  try {
    Database database(root.path() / "main.db");
    FAIL() << "a newer schema was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kConflict);
  }
}

/// Undoes kReviewSchema.
void DropReviewSchema(Connection& connection) {
  for (const char* table : {"deliveries", "webhooks", "measurements", "comments", "reviews"})
    connection.Execute(std::string("DROP TABLE ") + table);
  for (const char* column : {"maps DROP COLUMN review_state", "maps DROP COLUMN files_deleted_at",
                             "drives DROP COLUMN log_deleted_at", "sites DROP COLUMN title",
                             "sites DROP COLUMN note", "sites DROP COLUMN log_days",
                             "sites DROP COLUMN map_days", "sites DROP COLUMN default_rig"})
    connection.Execute(std::string("ALTER TABLE ") + column);
}

TEST(Database, TakesOverJobsOfTheSchemaBefore) {
  const TemporaryRoot root;
  {
    Database database(root.path() / "main.db");
    database.Write([](Connection& connection) {
      AddSite(connection, "lot");
      connection.Execute(
          R"(INSERT INTO drives (id, name, filename, site, state, bytes, sha256, created_at, updated_at)
                            VALUES ('d', 'a', 'a.bag', 'lot', 'processing', 1, 'x', 'now', 'now'))");
      connection.Execute(
          "INSERT INTO jobs (id, site, state, created_at) VALUES ('j', 'lot', 'queued', 'now')");
      connection.Execute("INSERT INTO job_drives (job, position, drive) VALUES ('j', 0, 'd')");
      connection.Execute(R"(INSERT INTO maps (id, site, version, job, sha256, created_at)
                            VALUES ('m', 'lot', 1, 'j', 'x', 'now'))");
      connection.Execute("INSERT INTO map_drives (map, position, drive) VALUES ('m', 0, 'd')");
      connection.Execute("ALTER TABLE jobs DROP COLUMN new_drive");
      connection.Execute("ALTER TABLE map_files DROP COLUMN pieces");
      connection.Execute("DROP INDEX drives_by_inspection");
      for (const char* column : {"inspection_state", "inspection", "created_by"})
        connection.Execute(std::string("ALTER TABLE drives DROP COLUMN ") + column);
      for (const char* table :
           {"uploads", "upload_sets", "file_checks", "sessions", "shares", "tokens", "audit"})
        connection.Execute(std::string("DROP TABLE ") + table);
      connection.Execute("DROP TABLE checklist_ticks");
      connection.Execute("ALTER TABLE sites DROP COLUMN review_checklist");
      DropReviewSchema(connection);
      connection.Execute("UPDATE jobs SET pid = 7");
      for (const char* column :
           {"not_before", "engine", "engine_id", "engine_waits", "cancel_asked", "last_stage"})
        connection.Execute(std::string("ALTER TABLE jobs DROP COLUMN ") + column);
      connection.Execute("PRAGMA user_version=3");
    });
  }
  Database database(root.path() / "main.db");

  database.Read([](Connection& connection) {
    EXPECT_EQ(FindJob(connection, "j").new_drive, std::nullopt)
        << "its drives stay as they were chosen";
    EXPECT_EQ(FindJob(connection, "j").place->pid, 7) << "to be killed where it lives";
    EXPECT_EQ(FindJob(connection, "j").drives, std::vector<std::string>{"d"});
    EXPECT_EQ(FindDrive(connection, "d").state, DriveState::kReady) << "it is in a map";
  });
}

TEST(Database, RefusesAFileThatIsNoDatabase) {
  const TemporaryRoot root;
  WriteText(root.path() / "main.db", std::string(8192, 'x'));

  EXPECT_THROW(Database(root.path() / "main.db"), Error);
}

TEST(Database, ServesManyThreads) {
  const TemporaryRoot root;
  Database database(root.path() / "main.db");
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&database, t] {
      for (int i = 0; i < 10; ++i) {
        database.Write([&](Connection& connection) {
          AddSite(connection, "site-" + std::to_string(t) + "-" + std::to_string(i));
        });
        CountSites(database);
      }
    });
  for (std::thread& thread : threads) thread.join();

  EXPECT_EQ(CountSites(database), 40);
}

}  // namespace
}  // namespace parkade

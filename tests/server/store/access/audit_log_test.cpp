#include "server/store/access/audit_log.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "server/store/access/caller.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class AuditLog : public testing::Test {
 protected:
  void Record(int count) {
    for (int i = 0; i < count; ++i)
      store_.database.Write([&](Connection& connection) {
        RecordAudit(connection, "drive.create", std::to_string(i), "{}");
      });
  }
  std::optional<std::string> Damage() { return store_.database.Read(DamageOfAudit); }
  void Change(const std::string& sql) {
    store_.database.Write([&](Connection& connection) { connection.Execute(sql); });
  }

  TemporaryRoot root_;
  Store store_{root_.path() / "data"};
};

TEST_F(AuditLog, SaysWhoDidWhat) {
  Caller anne;
  anne.id = "0123456789abcdef";
  anne.name = "anne";
  anne.address = "10.0.0.7";
  {
    const WorkFor scope(anne);
    Record(1);
  }
  Record(1);
  const std::vector<AuditEntry> entries =
      store_.database.Read([](Connection& connection) { return ListAudit(connection, Page()); });
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].caller_name, "service");
  EXPECT_EQ(entries[0].sequence, 2);
  EXPECT_EQ(entries[1].caller_name, "anne");
  EXPECT_EQ(entries[1].caller_id, "0123456789abcdef");
  EXPECT_EQ(entries[1].address, "10.0.0.7");
  EXPECT_EQ(entries[1].action, "drive.create");
  EXPECT_EQ(entries[1].subject, "0");
  EXPECT_EQ(Damage(), std::nullopt);
}

TEST_F(AuditLog, IsWithTheChangeOrNotAtAll) {
  EXPECT_THROW(store_.database.Write([](Connection& connection) {
    RecordAudit(connection, "drive.create", "0");
    throw Error(ErrorCode::kConflict, "thought better of it");
  }),
               Error);
  EXPECT_TRUE(
      store_.database.Read([](Connection& connection) { return ListAudit(connection, Page()); })
          .empty());
  Record(2);
  EXPECT_EQ(Damage(), std::nullopt);
}

TEST_F(AuditLog, AChangeOfAnyFieldIsFound) {
  for (const char* column :
       {"at", "caller", "caller_name", "address", "action", "subject", "detail", "sha256"}) {
    Record(3);
    ASSERT_EQ(Damage(), std::nullopt);
    Change(std::string("UPDATE audit SET ") + column + " = " + column +
           " || 'x' WHERE sequence = " + "(SELECT max(sequence) - 1 FROM audit)");
    EXPECT_NE(Damage().value_or("").find("was changed"), std::string::npos) << column;
    Change("DELETE FROM audit");
    Change("DELETE FROM sqlite_sequence WHERE name = 'audit'");
  }
}

TEST_F(AuditLog, AMissingEntryIsFound) {
  Record(4);
  Change("DELETE FROM audit WHERE sequence = 4");
  EXPECT_EQ(Damage(), "entry 4 of the audit log is missing");
  Change("DELETE FROM audit WHERE sequence = 1");
  EXPECT_EQ(Damage(), "entry 1 of the audit log is missing");
  Change("DELETE FROM audit");
  EXPECT_EQ(Damage(), "entry 1 of the audit log is missing");
}

TEST_F(AuditLog, TextsCannotPassForOthers) {
  store_.database.Write([](Connection& connection) {
    RecordAudit(connection, "a", "b\",\"c");
    RecordAudit(connection, "a\",\"b", std::string("\xff\x00", 2));
  });
  EXPECT_EQ(Damage(), std::nullopt);
}

}  // namespace
}  // namespace parkade

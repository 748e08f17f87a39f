#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "server/commands/commands.h"
#include "server/store/access/access_rules.h"
#include "server/store/access/tokens.h"
#include "server/store/data_directory.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

struct TokenArguments {
  std::string data = "data";
  std::string name, role = "viewer", id;
  std::vector<std::string> sites;
  bool pictures = false;
  int days = 0;
};

/// Calls `body` with the database of a data directory, which a service may be using.
template <typename Body>
void WithDatabase(const std::string& data, const Body& body) {
  const Caller caller = CallerWithAllRights("command line");
  const WorkFor scope(caller);
  std::optional<DataDirectory> own;
  try {
    own.emplace(data);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kConflict) throw;
  }
  Database database(std::filesystem::path(data) / "db" / "main.db",
                    own ? DatabaseUse::kOwn : DatabaseUse::kShare);
  body(database);
}

std::string SitesOf(const Token& token) {
  if (!token.sites) return "all";
  std::string text;
  for (const std::string& site : *token.sites) text += (text.empty() ? "" : ",") + site;
  return text;
}

/// The secret alone goes to the standard output, for scripts.
void Create(const TokenArguments& arguments) {
  Token wanted;
  wanted.name = arguments.name;
  const std::optional<Role> role = RoleFromText(arguments.role);
  Require(role.has_value(), ErrorCode::kUsage,
          "'" + arguments.role + "' is not a role: viewer, uploader, reviewer or admin");
  wanted.role = *role;
  if (!arguments.sites.empty()) wanted.sites = arguments.sites;
  wanted.may_see_pictures = arguments.pictures;
  if (arguments.days > 0) wanted.expires_at = EndAfterDays(arguments.days);
  WithDatabase(arguments.data, [&](Database& database) {
    const NewToken made = CreateToken(database, wanted);
    std::fprintf(stderr, "token %s of '%s': role %s, sites %s, ends %s. It is shown only once:\n",
                 made.token.id.c_str(), made.token.name.c_str(), ToText(made.token.role),
                 SitesOf(made.token).c_str(), made.token.expires_at.value_or("never").c_str());
    std::printf("%s\n", made.secret.c_str());
  });
}

const char* StateOf(const Token& token, const std::string& now) {
  if (token.revoked_at) return "revoked";
  return token.expires_at && *token.expires_at <= now ? "expired" : "valid";
}

void List(const TokenArguments& arguments) {
  WithDatabase(arguments.data, [](Database& database) {
    const std::string now = NowUtc();
    std::printf("%-16s %-8s %-8s %-8s %-24s %-24s %-20s %s\n", "id", "state", "role", "pictures",
                "ends", "used", "sites", "name");
    Page page;
    page.limit = 1'000'000;
    for (const Token& token :
         database.Read([&](Connection& connection) { return ListTokens(connection, page); }))
      std::printf("%-16s %-8s %-8s %-8s %-24s %-24s %-20s %s\n", token.id.c_str(),
                  StateOf(token, now), ToText(token.role), token.may_see_pictures ? "yes" : "no",
                  token.expires_at.value_or("never").c_str(),
                  token.used_at.value_or("never").c_str(), SitesOf(token).c_str(),
                  token.name.c_str());
  });
}

void Revoke(const TokenArguments& arguments) {
  WithDatabase(arguments.data, [&](Database& database) { RevokeToken(database, arguments.id); });
}

/// Adds one of the commands, and `run`s it when it is chosen.
CLI::App* AddOne(CLI::App& parent, Action& action, const std::shared_ptr<TokenArguments>& arguments,
                 const char* name, const char* what, void (*run)(const TokenArguments&)) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->add_option("--data", arguments->data, "the data directory of the service")
      ->capture_default_str();
  command->callback([arguments, run, &action] {
    action = [arguments, run] {
      run(*arguments);
      return 0;
    };
  });
  return command;
}

}  // namespace

void AddTokenCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<TokenArguments>();
  CLI::App* token = app.add_subcommand(
      "token", "Who may use the service: once a token was made, nobody gets in without one");
  token->require_subcommand(1);
  CLI::App* create = AddOne(*token, action, arguments, "create",
                            "Make a token and print it; a service may run meanwhile", Create);
  create->add_option("name", arguments->name, "whose it is, for people")->required();
  create->add_option("--role", arguments->role, "viewer, uploader, reviewer or admin")
      ->capture_default_str();
  create->add_option("--site", arguments->sites,
                     "a site it is for, several times for several; all");
  create->add_flag("--pictures", arguments->pictures, "it may see camera pictures");
  create->add_option("--days", arguments->days, "ends after so many days; never")
      ->check(CLI::Range(1, 3650));
  AddOne(*token, action, arguments, "list", "List all tokens, newest first", List);
  AddOne(*token, action, arguments, "revoke", "Let a token let nobody in any more", Revoke)
      ->add_option("id", arguments->id, "of the token, as the list gives it")
      ->required();
}

}  // namespace parkade

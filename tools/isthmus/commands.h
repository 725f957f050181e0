// The commands of the program. Each adds itself to the command line; its exit code is left in `exit_code` when it ran.
#pragma once

#include <CLI/App.hpp>

namespace isthmus::cli {

void add_register(CLI::App& app, int& exit_code);
void add_run(CLI::App& app, int& exit_code);
void add_solve(CLI::App& app, int& exit_code);
void add_explain(CLI::App& app, int& exit_code);
void add_pair(CLI::App& app, int& exit_code);
void add_inspect(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_evaluate(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_config(CLI::App& app, int& exit_code);
void add_clean(CLI::App& app, int& exit_code);
void add_plan(CLI::App& app, int& exit_code);
void add_submit(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_watch(CLI::App& app, int& exit_code);

}  // namespace isthmus::cli

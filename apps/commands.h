// The subcommands, in the order in which `abbe --help` lists them.
#pragma once

#include <array>

#include "apps/command.h"

namespace abbe::apps {

void AddInit(CLI::App& program, int& exit_code);
void AddDoctor(CLI::App& program, int& exit_code);
void AddRig(CLI::App& program, int& exit_code);
void AddAlign(CLI::App& program, int& exit_code);
void AddSweep(CLI::App& program, int& exit_code);
void AddRecord(CLI::App& program, int& exit_code);
void AddReduce(CLI::App& program, int& exit_code);
void AddCircle(CLI::App& program, int& exit_code);
void AddPath(CLI::App& program, int& exit_code);
void AddCalibrate(CLI::App& program, int& exit_code);
void AddPlate(CLI::App& program, int& exit_code);
void AddFuse(CLI::App& program, int& exit_code);
void AddTrack(CLI::App& program, int& exit_code);
void AddFollow(CLI::App& program, int& exit_code);
void AddDiagnose(CLI::App& program, int& exit_code);
void AddInvestigate(CLI::App& program, int& exit_code);
void AddCauses(CLI::App& program, int& exit_code);
void AddLearnedCommand(CLI::App& program, int& exit_code);
void AddHarmonics(CLI::App& program, int& exit_code);
void AddExport(CLI::App& program, int& exit_code);
void AddCorrect(CLI::App& program, int& exit_code);
void AddSimulate(CLI::App& program, int& exit_code);
void AddConvert(CLI::App& program, int& exit_code);
void AddSensitivity(CLI::App& program, int& exit_code);
void AddStudy(CLI::App& program, int& exit_code);
void AddCertificate(CLI::App& program, int& exit_code);
void AddHistory(CLI::App& program, int& exit_code);
void AddFleet(CLI::App& program, int& exit_code);
void AddLive(CLI::App& program, int& exit_code);
void AddReport(CLI::App& program, int& exit_code);
void AddCompletion(CLI::App& program, int& exit_code);
void AddMan(CLI::App& program, int& exit_code);

inline constexpr auto kCommands = std::to_array<AddCommand>(
    {AddInit,           AddDoctor,    AddRig,     AddAlign,       AddSweep,       AddRecord,
     AddReduce,         AddCalibrate, AddCircle,  AddPath,        AddHarmonics,   AddPlate,
     AddFuse,           AddTrack,     AddFollow,  AddDiagnose,    AddInvestigate, AddCauses,
     AddLearnedCommand, AddExport,    AddCorrect, AddSimulate,    AddConvert,     AddSensitivity,
     AddStudy,          AddHistory,   AddFleet,   AddCertificate, AddReport,      AddLive,
     AddCompletion,     AddMan});

}  // namespace abbe::apps

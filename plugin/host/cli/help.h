// All help texts of the command line, in one place. The keys of a shot file are described where they are
// parsed (plugin/format/shot), and printed by "pelagic keys".
#pragma once

#include <string>

namespace pelagic::cli::help {

extern const char* const kProgram;
extern const char* const kProgramFooter;
extern const char* const kVersion;
extern const char* const kVerbs;

extern const char* const kBake;
extern const char* const kBakeFooter;
extern const char* const kOut;
extern const char* const kFrames;
extern const char* const kThreads;
extern const char* const kInstructionSet;
extern const char* const kVerifySet;
extern const char* const kTrustTimes;
extern const char* const kChosen;
extern const char* const kJson;

extern const char* const kMaxMemory;
extern const char* const kPreviewMaxMemory;

extern const char* const kRender;
extern const char* const kRenderFooter;
extern const char* const kSize;
extern const char* const kOverscan;
extern const char* const kRegion;
extern const char* const kExposure;
extern const char* const kSamples;
extern const char* const kSkyQuality;
extern const char* const kTerms;
extern const char* const kShutter;
extern const char* const kAlpha;
extern const char* const kDeep;
extern const char* const kLayers;
extern const char* const kOcio;
extern const char* const kOcioDisplay;
extern const char* const kOcioView;
extern const char* const kOcioSpace;
extern const char* const kPrimaries;
extern const char* const kTrustPictures;

extern const char* const kPreview;
extern const char* const kPreviewFooter;
extern const char* const kOffscreen;
extern const char* const kFrame;
extern const char* const kPreviewSize;
extern const char* const kPreviewQuality;
extern const char* const kScale;
extern const char* const kScreenshot;
extern const char* const kAfter;
extern const char* const kPreviewThreads;

extern const char* const kNoPreview;

extern const char* const kExplain;
extern const char* const kExplainFooter;
extern const char* const kMeasure;
extern const char* const kMeasureThreads;

extern const char* const kAccuracy;
extern const char* const kAccuracyFooter;
extern const char* const kAccuracyShot;
extern const char* const kAccuracyOut;
extern const char* const kAccuracyRows;
extern const char* const kAccuracyRepeats;
extern const char* const kAccuracyPictures;
extern const char* const kAccuracyList;
extern const char* const kAccuracyThreads;

extern const char* const kVerify;
extern const char* const kVerifyFooter;
extern const char* const kFolders;
extern const char* const kVerifyThreads;

extern const char* const kFarm;
extern const char* const kFarmFooter;
extern const char* const kFarmOut;
extern const char* const kFarmVerb;
extern const char* const kFarmSubmit;
extern const char* const kFarmStatus;
extern const char* const kFarmTasks;
extern const char* const kFarmMinutes;
extern const char* const kFarmSbatch;
extern const char* const kFarmThreads;

extern const char* const kValidate;
extern const char* const kValidateFooter;

extern const char* const kPresets;
extern const char* const kPresetsFooter;
extern const char* const kCalibrate;
extern const char* const kCalibrateFooter;
extern const char* const kPresetSheet;
extern const char* const kPresetName;
extern const char* const kKeys;
extern const char* const kKeysFooter;

extern const char* const kShot;
extern const char* const kShots;
extern const char* const kHelp;

// The program's version, and how it was built.
std::string version_text();

}  // namespace pelagic::cli::help

//! Reads session, layout and recipe files, and the files that they name. Every error names the file, the line, what
//! was found and what would be valid.

pub mod carried;
pub mod file_error;
pub mod near_path;
pub mod overwrite;
pub mod parse;
pub mod replace_file;
pub mod rescue;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use serde::Deserialize;

use crate::files::file_error::{FileError, FileResult, missing, place_of, read_regular, read_text};
use crate::files::parse::{FileKind, ParsedFile, parse};
use crate::header::RecordedFile;
use crate::plan::{PlanSpec, QuestionnaireSpec, Study};
use crate::questionnaire::Questionnaire;
use crate::settings::SettingError;
use crate::tutorial::{Tutorial, TutorialStepKind};
use crate::wall_display::DisplaySpec;
use crate::{SessionSpec, ranges};
use tomcom_core::base::number_range::OutOfRange;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::compile::{KitchenFileError, KitchenFileKind};
use tomcom_core::kitchen::files::{LayoutSpec, RecipesSpec, check_layout};
use tomcom_core::mind::model::HumanModel;
use tomcom_people::wizard::WizardKind;

/// A session's settings with the kitchen and all other files that they name.
#[derive(Clone, Debug)]
pub struct SessionSetup {
    /// Path of the session file.
    pub path: PathBuf,
    pub spec: SessionSpec,
    pub kitchen: KitchenWithSources,
    /// Key bindings of the console.
    pub keys: Option<RecordedFile>,
    /// In the plan's order.
    pub questionnaires: Vec<Questionnaire>,
    pub tutorial: Option<Tutorial>,
}

impl SessionSetup {
    /// `None` if the settings contain no study plan.
    pub fn study(&self) -> Option<Study> {
        let kitchen = [&*self.kitchen.layout.text, &*self.kitchen.recipes.text];
        Study::new(&self.spec, self.questionnaires.clone(), self.tutorial.clone(), kitchen)
    }
}

/// Reads a session file and the files that it names. `language` replaces that of the participant's display. Keys are
/// not checked.
pub fn read_session(path: &Path, language: Option<&str>) -> FileResult<SessionSetup> {
    let text = read_text(path)?;
    let mut spec: SessionSpec = parse(path, &text)?;
    if let Some(language) = language {
        spec.display.language = language.to_string();
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let library = spec.lsl.as_mut().and_then(|lsl| lsl.library.as_mut());
    for (key, file) in [("tracker.file", spec.tracker.file.as_mut()), ("lsl.library", library)] {
        let Some(file) = file else { continue };
        // A recording's header has its settings as text.
        let beside = folder.join(&*file).into_os_string().into_string().map_err(|beside| {
            let found = format!("{}, no UTF-8", Path::new(&beside).display());
            let remedy = "a session file in a folder whose path is UTF-8";
            FileError::at(path, &text, place_of(&text, key, 0), found, remedy)
        })?;
        *file = beside;
    }
    if let Some(file) = &spec.human_model {
        if text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("human")) {
            let found = "human_model, beside a [human] table in the session file".to_string();
            let remedy = "one of the two: that file, or the [human] tables in here, which then have to go";
            return Err(FileError::at(path, &text, place_of(&text, "human_model", 0), found, remedy));
        }
        let model = folder.join(file);
        let remedy = "the path of a file with parameters of the human model, relative to the session file";
        check_there(&model, path, &text, ("human_model", 0, file), remedy)?;
        spec.human = read_human_model(&model)?;
    }
    read_words(path, &text, &mut spec)?;
    // In a study plan, the condition of a trial decides whether the wizard sees offers.
    if spec.plan.is_none() && spec.wizard.kind == WizardKind::Scripted {
        spec.wizard.offers.get_or_insert_default();
    }
    spec.check().map_err(|error| wrong_setting(path, &text, error))?;
    if let Some(step) = &spec.step {
        let found = format!("the place of a recording in the plan \"{}\"", step.plan);
        let remedy = "no [step]: the program finds it out from the plan and its recordings";
        return Err(FileError::at(path, &text, place_of(&text, "step.digest", 0), found, remedy));
    }
    let questionnaires = match &spec.plan {
        Some(plan) => read_questionnaires(path, &text, &spec, plan)?,
        None => Vec::new(),
    };
    let layout_path = folder.join(&spec.layout);
    let remedy = "the path of a layout file, relative to the session file";
    check_there(&layout_path, path, &text, ("layout", 0, &spec.layout), remedy)?;
    let keys = read_keys(path, &text, &spec)?;
    let mut kitchen = read_kitchen(&layout_path)?;
    kitchen.layout.path.clone_from(&spec.layout);
    spec.check_kitchen(&kitchen.kitchen).map_err(|error| wrong_setting(path, &text, error))?;
    let tutorial = read_tutorial(path, &text, &spec, &kitchen.kitchen)?;
    Ok(SessionSetup { path: path.to_path_buf(), spec, kitchen, keys, questionnaires, tutorial })
}

fn read_keys(session: &Path, text: &str, spec: &SessionSpec) -> FileResult<Option<RecordedFile>> {
    let Some(name) = &spec.console.keys else { return Ok(None) };
    let path = session.parent().unwrap_or(Path::new(".")).join(name);
    let keys = read_regular(&path).map_err(|reason| {
        let remedy = "the path of a key file, relative to the session file; tomcom keys prints one";
        missing(session, text, ("console.keys", 0, name), reason, remedy)
    })?;
    Ok(Some(RecordedFile { path: path.display().to_string(), text: keys }))
}

/// A file that a session file names must exist; the setting that names it is given as to [`missing`].
fn check_there(path: &Path, session: &Path, text: &str, setting: (&str, usize, &str), remedy: &str) -> FileResult<()> {
    let there = if carried::instead_of(path).is_some() { Ok(()) } else { std::fs::metadata(path).map(drop) };
    there.map_err(|reason| missing(session, text, setting, reason, remedy))
}

/// In the plan's order, and in the session's language.
fn read_questionnaires(
    session: &Path,
    text: &str,
    spec: &SessionSpec,
    plan: &PlanSpec,
) -> FileResult<Vec<Questionnaire>> {
    let folder = session.parent().unwrap_or(Path::new("."));
    let read = |(nth, asked): (usize, &QuestionnaireSpec)| {
        let path = in_language(folder.join(&asked.file), spec.display.code());
        let remedy = "the path of a questionnaire, relative to the session file";
        check_there(&path, session, text, ("questionnaire.file", nth, &asked.file), remedy)?;
        let text = read_text(&path)?;
        let questionnaire: Questionnaire = parse(&path, &text)?;
        questionnaire.check().map_err(|error| wrong_setting(&path, &text, error))?;
        Ok(questionnaire)
    };
    plan.questionnaire.iter().enumerate().map(read).collect()
}

/// In the session's language; it has to fit the kitchen.
fn read_tutorial(session: &Path, text: &str, spec: &SessionSpec, kitchen: &Kitchen) -> FileResult<Option<Tutorial>> {
    let Some(file) = spec.plan.as_ref().and_then(|plan| plan.tutorial.as_ref()) else { return Ok(None) };
    let path = in_language(session.parent().unwrap_or(Path::new(".")).join(file), spec.display.code());
    let remedy = "the path of a tutorial, relative to the session file";
    check_there(&path, session, text, ("plan.tutorial", 0, file), remedy)?;
    let text = read_text(&path)?;
    let mut tutorial: Tutorial = parse(&path, &text)?;
    tutorial.check().map_err(|error| wrong_setting(&path, &text, error))?;
    tutorial.check_kitchen(kitchen).map_err(|error| {
        let found =
            format!("a tutorial that does not fit the kitchen \"{}\" of the session: {}", kitchen.name, error.found);
        let remedy = format!("{}; or, in {}, a tutorial of this kitchen", error.remedy, session.display());
        wrong_setting(&path, &text, SettingError { found, remedy: remedy.into(), ..error })
    })?;
    tutorial.steps.retain(|step| step.kind != TutorialStepKind::Probe || spec.probes.is_some());
    Ok(Some(tutorial))
}

/// Path of a file's translation into this language, if there is such a file beside it: `acceptance.de.toml` beside
/// `acceptance.toml`.
pub fn in_language(path: PathBuf, code: &str) -> PathBuf {
    // A setting that names a file of texts instead of a language has a path here, not a language code.
    let is_code = code.chars().all(|sign| sign.is_ascii_alphanumeric() || sign == '-');
    let own = is_code.then(|| path.with_extension(format!("{code}.toml")));
    own.filter(|own| own.is_file() || carried::instead_of(own).is_some()).unwrap_or(path)
}

fn wrong_setting(path: &Path, text: &str, error: SettingError) -> FileError {
    FileError::at(path, text, place_of(text, &error.path, error.nth), error.found, error.remedy.into_owned())
}

/// Parameters that the file does not name have their defaults.
pub fn read_human_model(path: &Path) -> FileResult<HumanModel> {
    let text = read_text(path)?;
    let model: HumanModel = parse(path, &text)?;
    let rule = model.fault().map(|(path, found, remedy)| SettingError::new(path, found, remedy));
    let wrong = ranges::check_human_model(&model).err().map(SettingError::from).or(rule);
    if let Some(error) = wrong {
        let inside = error.path.strip_prefix(ranges::HUMAN).unwrap_or(&error.path).trim_start_matches('.');
        return Err(FileError::at(path, &text, place_of(&text, inside, 0), error.found, error.remedy.into_owned()));
    }
    Ok(model)
}

/// With its source texts, which go into the header of every recording.
#[derive(Clone, Debug)]
pub struct KitchenWithSources {
    pub kitchen: Kitchen,
    pub layout: RecordedFile,
    /// Its path is written as in the layout file.
    pub recipes: RecordedFile,
}

/// Reads a layout file and the recipe file that it names.
pub fn read_kitchen(layout_path: &Path) -> FileResult<KitchenWithSources> {
    let layout_text = read_text(layout_path)?;
    let layout: LayoutSpec = parse(layout_path, &layout_text)?;
    let folder = layout_path.parent().unwrap_or(Path::new("."));
    let recipes_path = folder.join(layout.recipes.get_ref());
    let recipes_text = carried::read(&recipes_path).map_err(|reason| {
        let near = near_path::did_you_mean(&recipes_path, folder);
        let found = format!("recipes = \"{}\", which cannot be read: {reason}{near}", layout.recipes.get_ref());
        let remedy = "the path of a recipe file, relative to the layout file";
        FileError::at(layout_path, &layout_text, Some(layout.recipes.span()), found, remedy)
    })?;
    let files = compile_kitchen((layout_path, layout_text), (&recipes_path, recipes_text))?;
    #[cfg(feature = "physics")]
    check_reach(layout_path, &files.layout.text, &layout, &files.kitchen)?;
    Ok(files)
}

/// The paths serve error messages only.
pub fn compile_kitchen(layout: (&Path, String), recipes: (&Path, String)) -> FileResult<KitchenWithSources> {
    let layout_spec: LayoutSpec = parse(layout.0, &layout.1)?;
    let range = |OutOfRange { place, found, remedy, .. }| FileError::at(layout.0, &layout.1, place, found, remedy);
    check_layout(&layout.1).map_err(range)?;
    let recipes_spec: RecipesSpec = parse(recipes.0, &recipes.1)?;
    let wrong = |KitchenFileError { file, span, found, remedy }| {
        let (path, text) = match file {
            KitchenFileKind::Layout => (layout.0, &layout.1),
            KitchenFileKind::Recipes => (recipes.0, &recipes.1),
        };
        FileError::at(path, text, span, found, remedy)
    };
    let kitchen = Kitchen::compile(&layout_spec, &recipes_spec).map_err(wrong)?;
    let layout = RecordedFile { path: layout.0.display().to_string(), text: layout.1 };
    let recipes = RecordedFile { path: layout_spec.recipes.into_inner(), text: recipes.1 };
    Ok(KitchenWithSources { kitchen, layout, recipes })
}

/// Whether the arm can reach all of the robot's buttons.
#[cfg(feature = "physics")]
fn check_reach(path: &Path, text: &str, layout: &LayoutSpec, kitchen: &Kitchen) -> FileResult<()> {
    let Some((button, why)) = tomcom_arm::reach::out_of_reach(kitchen) else { return Ok(()) };
    let button = kitchen.button(tomcom_core::kitchen::Agent::Robot, button);
    let [x, y] = button.at_m;
    let place = layout.buttons().find(|spec| *spec.at_m.get_ref() == button.at_m).map(|spec| spec.at_m.span());
    let found = format!("the robot's button \"{}\" at x = {x} m, y = {y} m, {}", button.name, why.words());
    let remedy = "a place about 0.2 to 0.75 m from the robot's base, and not beside or behind it";
    Err(FileError::at(path, text, place, found, remedy))
}

/// Translations of the display's texts, by the English originals, for a language that is not built in.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct LanguageFile(pub BTreeMap<String, String>);

impl ParsedFile for LanguageFile {
    const KIND: FileKind = FileKind::Language;
}

/// Texts in the session file take precedence over those of its language file.
fn read_words(session: &Path, text: &str, spec: &mut SessionSpec) -> FileResult<()> {
    let language = &spec.display.language;
    if DisplaySpec::LANGUAGES.contains(&language.as_str()) {
        return Ok(());
    }
    let path = session.parent().unwrap_or(Path::new(".")).join(language);
    let codes = DisplaySpec::LANGUAGES.map(|code| format!("\"{code}\"")).join(", ");
    let remedy = format!("{codes}, or the path of a file with words, relative to the session file");
    check_there(&path, session, text, ("display.language", 0, language), &remedy)?;
    let LanguageFile(mut words) = parse(&path, &read_text(&path)?)?;
    words.append(&mut spec.display.words);
    spec.display.words = words;
    Ok(())
}

/// A date and time in UTC, for files beside recordings: from the wall clock, which can be set and can jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WallTime(Timestamp);

impl WallTime {
    pub fn now() -> WallTime {
        WallTime(Timestamp::now())
    }

    /// Since the beginning of 1970.
    pub fn millis(self) -> i64 {
        self.0.as_millisecond()
    }

    pub fn after_millis(self, millis: i64) -> WallTime {
        WallTime(self.0 + jiff::SignedDuration::from_millis(millis))
    }

    /// "2026-03-14".
    pub fn date(self) -> String {
        self.0.strftime("%F").to_string()
    }

    /// "2026-03-14T09:26:53.589Z" (RFC 3339).
    pub fn rfc3339(self) -> String {
        self.0.strftime("%FT%T.%3fZ").to_string()
    }
}

//! Reads session, layout and recipe files. Every error names the file, the line, what was found and what would be
//! valid.

pub mod file_error;
pub mod known_settings;
pub mod language;
pub mod overwrite;
pub mod parse;
pub mod place;
pub mod replace_file;
pub mod rescue;
pub mod wall_time;

use std::path::{Path, PathBuf};

use self::file_error::{FileError, FileResult, missing, read_regular, read_text};
use self::language::read_words;
use self::parse::parse;
use self::place::place_of;
use crate::SessionSpec;
use crate::header::RecordedFile;
use crate::plan::{PlanSpec, Questionnaire, QuestionnaireSpec, Study, Tutorial};
use crate::ranges;
use crate::settings::SettingError;
use tomcom_core::base::number_range::OutOfRange;
use tomcom_core::kitchen::compile::{KitchenFileError, KitchenFileKind};
use tomcom_core::kitchen::files::LayoutSpec;
use tomcom_core::kitchen::files::RecipesSpec;
use tomcom_core::kitchen::{Kitchen, files};
use tomcom_core::mind::model::HumanModel;
use tomcom_people::wizard::WizardKind;

/// A session's settings with the kitchen and all other files that they name.
#[derive(Clone, Debug)]
pub struct SessionSetup {
    /// Settings of the session, from the session file.
    pub spec: SessionSpec,
    /// Kitchen of the session, with its layout and recipe files.
    pub kitchen: KitchenWithSources,
    /// Key file (key bindings of the console); `None` if the settings name none.
    pub keys: Option<RecordedFile>,
    /// Questionnaires that the study plan names, in the plan's order.
    pub questionnaires: Vec<Questionnaire>,
    /// Tutorial that the study plan names; `None` if the plan has no tutorial.
    pub tutorial: Option<Tutorial>,
}

impl SessionSetup {
    /// The study that these settings plan; `None` if the settings contain no study plan.
    pub fn study(&self) -> Option<Study> {
        let kitchen = [&*self.kitchen.layout.text, &*self.kitchen.recipes.text];
        Study::new(&self.spec, self.questionnaires.clone(), self.tutorial.clone(), kitchen)
    }
}

/// Reads a session file, the layout and the key file that it names, and the recipes that the layout names. `language`:
/// of the texts of the participant's display, in place of that of the session file. Keys are not checked.
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
            let remedy = "a session file in a folder whose path is UTF-8".to_string();
            FileError::at(path, &text, place_of(&text, key, 0), found, remedy)
        })?;
        *file = beside;
    }
    if let Some(file) = &spec.human_model {
        if text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("human")) {
            let found = "human_model, beside a [human] table in the session file".to_string();
            let remedy = "one of the two: that file, or the [human] tables in here, which then have to go".to_string();
            return Err(FileError::at(path, &text, place_of(&text, "human_model", 0), found, remedy));
        }
        let model = folder.join(file);
        if let Err(reason) = std::fs::metadata(&model) {
            let remedy = "the path of a file with parameters of the human model, relative to the session file";
            return Err(missing(path, &text, ("human_model", 0, file), reason, remedy));
        }
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
        let remedy = "no [step]: the program finds it out from the plan and its recordings".to_string();
        return Err(FileError::at(path, &text, place_of(&text, "step.digest", 0), found, remedy));
    }
    let questionnaires = match &spec.plan {
        Some(plan) => read_questionnaires(path, &text, &spec, plan)?,
        None => Vec::new(),
    };
    let layout_path = folder.join(&spec.layout);
    if let Err(reason) = std::fs::metadata(&layout_path) {
        let remedy = "the path of a layout file, relative to the session file";
        return Err(missing(path, &text, ("layout", 0, &spec.layout), reason, remedy));
    }
    let keys = read_keys(path, &text, &spec)?;
    let mut kitchen = read_kitchen(&layout_path)?;
    kitchen.layout.path.clone_from(&spec.layout);
    spec.check_kitchen(&kitchen.kitchen).map_err(|error| wrong_setting(path, &text, error))?;
    let tutorial = read_tutorial(path, &text, &spec, &kitchen.kitchen)?;
    Ok(SessionSetup { spec, kitchen, keys, questionnaires, tutorial })
}

/// Reads the key file that the session file names; `None` if the session file names no key file.
fn read_keys(session: &Path, text: &str, spec: &SessionSpec) -> FileResult<Option<RecordedFile>> {
    let Some(name) = &spec.console.keys else { return Ok(None) };
    let path = session.parent().unwrap_or(Path::new(".")).join(name);
    let keys = read_regular(&path).map_err(|reason| {
        let remedy = "the path of a key file, relative to the session file; tomcom keys prints one";
        missing(session, text, ("console.keys", 0, name), reason, remedy)
    })?;
    Ok(Some(RecordedFile { path: path.display().to_string(), text: keys }))
}

/// Reads the questionnaires that a study plan names, in the plan's order and in the session's language.
fn read_questionnaires(
    session: &Path,
    text: &str,
    spec: &SessionSpec,
    plan: &PlanSpec,
) -> FileResult<Vec<Questionnaire>> {
    let folder = session.parent().unwrap_or(Path::new("."));
    let read = |(nth, asked): (usize, &QuestionnaireSpec)| {
        let path = in_language(folder.join(&asked.file), spec.display.code());
        if let Err(reason) = std::fs::metadata(&path) {
            let remedy = "the path of a questionnaire, relative to the session file";
            return Err(missing(session, text, ("questionnaire.file", nth, &asked.file), reason, remedy));
        }
        let text = read_text(&path)?;
        let questionnaire: Questionnaire = parse(&path, &text)?;
        questionnaire.check().map_err(|error| wrong_setting(&path, &text, error))?;
        Ok(questionnaire)
    };
    plan.questionnaire.iter().enumerate().map(read).collect()
}

/// Reads the tutorial that a study plan names, in the session's language, and checks that it fits the kitchen.
fn read_tutorial(session: &Path, text: &str, spec: &SessionSpec, kitchen: &Kitchen) -> FileResult<Option<Tutorial>> {
    let Some(file) = spec.plan.as_ref().and_then(|plan| plan.tutorial.as_ref()) else { return Ok(None) };
    let path = in_language(session.parent().unwrap_or(Path::new(".")).join(file), spec.display.code());
    if let Err(reason) = std::fs::metadata(&path) {
        let remedy = "the path of a tutorial, relative to the session file";
        return Err(missing(session, text, ("plan.tutorial", 0, file), reason, remedy));
    }
    let text = read_text(&path)?;
    let tutorial: Tutorial = parse(&path, &text)?;
    let checked = tutorial.check().and_then(|()| tutorial.check_kitchen(kitchen));
    checked.map_err(|error| wrong_setting(&path, &text, error))?;
    Ok(Some(tutorial))
}

/// Path of a file's translation into this language, if there is such a file beside it: `acceptance.de.toml` beside
/// `acceptance.toml`.
fn in_language(path: PathBuf, code: &str) -> PathBuf {
    // A setting that names a file of texts instead of a language has a path here, not a language code.
    let is_code = code.chars().all(|sign| sign.is_ascii_alphanumeric() || sign == '-');
    let own = is_code.then(|| path.with_extension(format!("{code}.toml")));
    own.filter(|own| own.is_file()).unwrap_or(path)
}

/// The error about an invalid setting at its place in a file's text.
fn wrong_setting(path: &Path, text: &str, error: SettingError) -> FileError {
    FileError::at(path, text, place_of(text, &error.path, error.nth), error.found, error.remedy.into_owned())
}

/// Reads a file with parameters of the human model; parameters that the file does not name have their defaults.
///
/// # Errors
/// The file cannot be read, or a parameter is invalid.
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

/// The default session with its kitchen; both are part of the program, so that it runs without any file.
///
/// # Errors
/// Occurs only if the program was built from invalid files.
pub fn built_in_session() -> FileResult<SessionSetup> {
    let spec: SessionSpec = parse(Path::new("sessions/default.toml"), include_str!("../../../sessions/default.toml"))?;
    let layout = (Path::new(&spec.layout), include_str!("../../../layouts/sushi.toml").to_string());
    let recipes = (Path::new("../recipes/sushi.toml"), include_str!("../../../recipes/sushi.toml").to_string());
    let kitchen = compile_kitchen(layout, recipes)?;
    Ok(SessionSetup { spec, kitchen, keys: None, questionnaires: Vec::new(), tutorial: None })
}

/// A compiled kitchen with its source texts, which go into the header of every recording.
#[derive(Clone, Debug)]
pub struct KitchenWithSources {
    /// Kitchen, compiled from its layout and recipe files.
    pub kitchen: Kitchen,
    /// Layout file of the kitchen.
    pub layout: RecordedFile,
    /// Recipe file of the kitchen; its path is written as in the layout file.
    pub recipes: RecordedFile,
}

/// Reads a layout file and the recipe file that it names.
pub fn read_kitchen(layout_path: &Path) -> FileResult<KitchenWithSources> {
    let layout_text = read_text(layout_path)?;
    let layout: LayoutSpec = parse(layout_path, &layout_text)?;
    let folder = layout_path.parent().unwrap_or(Path::new("."));
    let recipes_path = folder.join(layout.recipes.get_ref());
    let recipes_text = read_regular(&recipes_path).map_err(|reason| {
        let found = format!("recipes = \"{}\", which cannot be read: {reason}", layout.recipes.get_ref());
        let remedy = "the path of a recipe file, relative to the layout file".to_string();
        FileError::at(layout_path, &layout_text, Some(layout.recipes.span()), found, remedy)
    })?;
    let files = compile_kitchen((layout_path, layout_text), (&recipes_path, recipes_text))?;
    #[cfg(feature = "physics")]
    check_reach(layout_path, &files.layout.text, &layout, &files.kitchen)?;
    Ok(files)
}

/// The error about a layout file with a number outside of its allowed range.
fn wrong_layout(path: &Path, text: &str, error: OutOfRange) -> FileError {
    FileError::at(path, text, error.place, error.found, error.remedy)
}

/// Compiles a kitchen from the texts of its layout and recipe files. The paths serve error messages only.
pub fn compile_kitchen(layout: (&Path, String), recipes: (&Path, String)) -> FileResult<KitchenWithSources> {
    let layout_spec: LayoutSpec = parse(layout.0, &layout.1)?;
    layout_ranges::check(&layout.1).map_err(|error| wrong_layout(layout.0, &layout.1, error))?;
    let recipes_spec: RecipesSpec = parse(recipes.0, &recipes.1)?;
    match Kitchen::compile(&layout_spec, &recipes_spec) {
        Ok(kitchen) => {
            let layout_text = RecordedFile { path: layout.0.display().to_string(), text: layout.1 };
            let recipes_text = RecordedFile { path: layout_spec.recipes.into_inner(), text: recipes.1 };
            Ok(KitchenWithSources { kitchen, layout: layout_text, recipes: recipes_text })
        }
        Err(KitchenFileError { file, span, found, remedy }) => {
            let (path, text) = match file {
                KitchenFileKind::Layout => (layout.0, &layout.1),
                KitchenFileKind::Recipes => (recipes.0, &recipes.1),
            };
            Err(FileError::at(path, text, span, found, remedy))
        }
    }
}

/// Checks that the robot's arm can reach all of the robot's buttons.
#[cfg(feature = "physics")]
fn check_reach(path: &Path, text: &str, layout: &LayoutSpec, kitchen: &Kitchen) -> FileResult<()> {
    let Some((button, why)) = tomcom_arm::reach::out_of_reach(kitchen) else { return Ok(()) };
    let button = kitchen.button(tomcom_core::kitchen::Agent::Robot, button);
    let [x, y] = button.at_m;
    let place = layout.buttons().find(|spec| *spec.at_m.get_ref() == button.at_m).map(|spec| spec.at_m.span());
    let found = format!("the robot's button \"{}\" at x = {x} m, y = {y} m, {}", button.name, why.words());
    let remedy = "a place about 0.2 to 0.75 m from the robot's base, and not beside or behind it".to_string();
    Err(FileError::at(path, text, place, found, remedy))
}

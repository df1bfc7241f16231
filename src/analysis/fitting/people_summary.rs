//! What `tomcom fit --people` prints: the population, the persons with their shrinkage towards the population, and the
//! trials that were left out of the fit.

use serde::Serialize;

use super::HALF_WIDTH;
use super::population_estimate::{PersonPosterior, PopulationEstimate};
use crate::base::words::count;
use crate::mind::fitted_people::HumanModelFile;
use crate::mind::fitting::HumanModelParameter;

/// A person to whose trials parameters are fitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersonRecordingCount {
    /// Code of the person, with the seed in front where simulated people of several seeds are fitted.
    pub code: String,
    /// Number of the person's recordings.
    pub recordings: u64,
}

/// The output of `tomcom fit --people`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeopleSummary {
    /// Number of recordings that the fit used.
    pub recordings: u64,
    /// Number of presses of the human in the fitted recordings.
    pub human_actions: u64,
    /// Number of answers to freeze probes that the fit used.
    pub answers: u64,
    /// Log likelihood per press with one set of parameters for all persons, in nats.
    pub log_likelihood_pooled: f64,
    /// Log likelihood per press with each person's own parameters, in nats, on the presses to which they were fitted.
    pub log_likelihood: f64,
    /// Number of parameter sets tried on all trials, including those tried without each person's last trial.
    pub tries: u64,
    /// Whether all searches converged.
    pub converged: bool,
    /// Parameters of the fit with one set of parameters for all persons.
    pub pooled: Vec<PooledParameter>,
    /// Distribution of each parameter in the population.
    pub population: Vec<PopulationParameter>,
    /// The fitted parameters of each person.
    pub people: Vec<PersonSummary>,
    /// Results on the last trials of persons with several trials, under parameters that were fitted without these
    /// trials; null if nobody has several trials.
    pub held_out: Option<HeldOut>,
    /// The file of fitted parameters, with the population's median person, and every person.
    #[serde(skip)]
    pub file: HumanModelFile,
}

/// A parameter of the fit in which one set of parameters holds for all persons.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PooledParameter {
    /// The parameter's name in a parameter file.
    pub name: &'static str,
    /// Fitted value of the parameter, the same for all persons.
    pub value: f64,
}

impl PooledParameter {
    /// A pooled parameter with its value at the point `at` on the scale of the fit.
    pub fn new(parameter: HumanModelParameter, at: f64) -> PooledParameter {
        PooledParameter { name: parameter.name(), value: parameter.from_scale(at) }
    }
}

/// Distribution of a parameter in the population of persons.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PopulationParameter {
    /// The parameter's name in a parameter file.
    pub name: &'static str,
    /// Unit of the parameter; empty if it has none.
    pub unit: &'static str,
    /// Value of the parameter for the median person, which is the population's mean on the scale of the fit.
    pub value: f64,
    /// The 95 % interval of the median person's value.
    pub interval: [f64; 2],
    /// The two values of the parameter between which 95 % of the population lie.
    pub persons_between: [f64; 2],
    /// Mean of the population on the scale of the fit.
    pub scale_mean: f64,
    /// Standard error of the population's mean on the scale of the fit.
    pub scale_mean_error: f64,
    /// Standard deviation of the parameter between persons, on the scale of the fit.
    pub scale_sd: f64,
    /// The 95 % interval of the standard deviation between persons; an end beyond 0.01 to 5 is null.
    pub scale_sd_interval: [Option<f64>; 2],
    /// Mean over persons of the shrinkage of the parameter (0: a person's presses decide; 1: the population does).
    pub shrinkage: f64,
}

impl PopulationParameter {
    /// The distributions of all parameters in a population.
    pub fn all(parameters: &[HumanModelParameter], population: &PopulationEstimate) -> Vec<PopulationParameter> {
        let one = |(index, parameter): (usize, &HumanModelParameter)| {
            let (mean, error) = (population.mean[index], population.mean_error[index]);
            let sd = population.sd[index];
            let people = population.people.len().max(1) as f64;
            PopulationParameter {
                name: parameter.name(),
                unit: parameter.unit(),
                value: value_inside(*parameter, mean),
                interval: around(*parameter, mean, error),
                persons_between: around(*parameter, mean, sd),
                scale_mean: mean,
                scale_mean_error: error,
                scale_sd: sd,
                scale_sd_interval: population.sd_interval[index],
                shrinkage: population.people.iter().map(|person| person.shrinkage[index]).sum::<f64>() / people,
            }
        };
        parameters.iter().enumerate().map(one).collect()
    }
}

/// The fitted parameters of one person.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PersonSummary {
    /// Code of the person.
    pub code: String,
    /// Number of the person's recordings.
    pub recordings: u64,
    /// Number of the person's presses.
    pub human_actions: u64,
    /// The person's fitted parameters.
    pub parameters: Vec<PersonParameter>,
}

/// A fitted parameter of one person.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PersonParameter {
    /// The parameter's name in a parameter file.
    pub name: &'static str,
    /// The mode of the parameter's posterior, from the person's own presses and from the population.
    pub value: f64,
    /// The 95 % interval of the person's value by Laplace's approximation around the mode, within the bounds of the
    /// search.
    pub interval: [f64; 2],
    /// Standard deviation of the posterior of the person's parameter, on the scale of the fit.
    pub scale_sd: f64,
    /// Variance of the person's parameter given the population, divided by the variance of the population. 1: nothing
    /// but the population is known; 0: the population makes no difference.
    pub shrinkage: f64,
}

impl PersonSummary {
    /// Summary of a person with this number of presses, from the posterior of the person's parameters.
    pub fn from_posterior(
        person: &PersonRecordingCount,
        human_actions: u64,
        parameters: &[HumanModelParameter],
        posterior: &PersonPosterior,
    ) -> PersonSummary {
        let one = |(index, parameter): (usize, &HumanModelParameter)| {
            let (mode, sd) = (posterior.mode[index], posterior.sd[index]);
            PersonParameter {
                name: parameter.name(),
                value: value_inside(*parameter, mode),
                interval: around(*parameter, mode, sd),
                scale_sd: sd,
                shrinkage: posterior.shrinkage[index],
            }
        };
        let parameters = parameters.iter().enumerate().map(one).collect();
        PersonSummary { code: person.code.clone(), recordings: person.recordings, human_actions, parameters }
    }
}

/// Value of the parameter at a point on the scale of the fit, moved inside the bounds of the search.
fn value_inside(parameter: HumanModelParameter, at: f64) -> f64 {
    let [low, high] = parameter.bounds().map(|end| parameter.to_scale(end));
    parameter.from_scale(at.clamp(low, high))
}

/// The parameter's values 1.96 standard deviations below and above a point on the scale of the fit.
fn around(parameter: HumanModelParameter, at: f64, sd: f64) -> [f64; 2] {
    [-HALF_WIDTH, HALF_WIDTH].map(|width| value_inside(parameter, at + width * sd))
}

/// How likely the presses of trials that were left out of a fit are: means over persons of log likelihoods per press,
/// in nats.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldOut {
    /// Codes of persons with only one trial, which is used to fit the population, and not to judge the fit.
    pub left_out: Vec<String>,
    /// Gain in log likelihood of the persons' own parameters over one set for all; null with fewer than two persons.
    pub gain: Option<HeldOutGain>,
    /// Gain of the persons' own parameters over the population's median person; both use the other persons' trials
    /// alike.
    pub population_gain: Option<HeldOutGain>,
    /// Log likelihoods of each person's trial that was left out.
    pub by_person: Vec<HeldOutPerson>,
}

/// Difference of log likelihoods between two fits, paired by person, in nats per press.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldOutGain {
    /// Mean of the difference over persons, in nats per press.
    pub mean: f64,
    /// The 95 % interval of the mean difference by Student's t.
    pub interval: [f64; 2],
}

/// Log likelihoods per press, in nats, of a person's trial that was left out of the fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldOutPerson {
    /// Code of the person whose trial was left out.
    pub code: String,
    /// Number of the human's presses in the trial.
    pub human_actions: u64,
    /// Log likelihood per press with one set of parameters for all persons.
    pub pooled: f64,
    /// Log likelihood per press with the parameters of the population's median person.
    pub population: f64,
    /// Log likelihood per press with the person's own parameters.
    pub own: f64,
}

impl HeldOut {
    fn mean(&self, of: impl Fn(&HeldOutPerson) -> f64) -> f64 {
        self.by_person.iter().map(of).sum::<f64>() / self.by_person.len().max(1) as f64
    }

    fn describe(&self) -> String {
        let presses: u64 = self.by_person.iter().map(|one| one.human_actions).sum();
        let better = self.by_person.iter().filter(|one| one.own > one.pooled).count();
        let gain = |name: &str, gain: Option<HeldOutGain>| match gain {
            Some(HeldOutGain { mean, interval: [low, high] }) => {
                format!("gain over {name} {mean:+.4} (95 % {low:+.4} to {high:+.4})")
            }
            None => format!("gain over {name} not known: it takes two persons"),
        };
        let mut text = format!(
            "\nheld out: the last trial of {}, {}, after a fit without these trials; log likelihood per press, mean over persons\n  \
             one set of parameters for all {:.4}, the median person {:.4}, each person's own {:.4}\n  {}, better for {better} of {}\n  {}\n",
            count(self.by_person.len() as u64, "person", "persons"),
            count(presses, "press", "presses"),
            self.mean(|one| one.pooled),
            self.mean(|one| one.population),
            self.mean(|one| one.own),
            gain("one set for all", self.gain),
            self.by_person.len(),
            gain("the median person", self.population_gain),
        );
        if !self.left_out.is_empty() {
            text += &format!("  not judged, with one trial only: {}\n", self.left_out.join(", "));
        }
        text
    }
}

/// Comment at the top of a file with fitted population and persons; its beginning is the same in all fitted files.
pub fn people_comment(fitted: &str, found: &PeopleSummary) -> String {
    format!(
        "{fitted} {} of {} with {} of the human.\nThe tables hold the median person, [people.CODE] a person's own parameters. \
         Fitted: {}",
        count(found.recordings, "recording", "recordings"),
        count(found.people.len() as u64, "person", "persons"),
        count(found.human_actions, "press", "presses"),
        found.population.iter().map(|one| one.name).collect::<Vec<_>>().join(", "),
    )
}

/// Fitted population, persons and trials that were left out, as text.
pub fn describe_people(found: &PeopleSummary) -> String {
    let mut text = format!(
        "{}, {}, {} of the human{}; {}\nlog likelihood per press: one set of parameters for all {:.4}, each person's own {:.4} (on \
         the presses that they are fitted to)\n",
        count(found.people.len() as u64, "person", "persons"),
        count(found.recordings, "recording", "recordings"),
        count(found.human_actions, "press", "presses"),
        match found.answers {
            0 => String::new(),
            answers => format!(", {} to probes", count(answers, "answer", "answers")),
        },
        count(found.tries, "try", "tries"),
        found.log_likelihood_pooled,
        found.log_likelihood,
    );
    if !found.converged {
        text += "a search did not come to its end: the values are the best that it knew; a larger --tries, or more samples \
                 ([inference] in a file for --start), may end it\n";
    }
    text += &format!(
        "\n{:<26}{:>10}{:>16}{:>22}{:>20}{:>8}{:>16}{:>11}\n",
        "population", "pooled", "median person", "95 %", "95 % of persons", "sd", "95 %", "shrinkage",
    );
    for (one, pooled) in found.population.iter().zip(&found.pooled) {
        let [low, high] = one.scale_sd_interval.map(|end| end.map(|sd| format!("{sd:.2}")));
        let sds = format!("{} to {}", low.as_deref().unwrap_or("0"), high.as_deref().unwrap_or("?"));
        text += &format!(
            "{:<26}{:>10}{:>16}{:>22}{:>20}{:>8.2}{sds:>16}{:>11.2}\n",
            format!("{} ({})", one.name, one.unit),
            figure(pooled.value),
            figure(one.value),
            span(one.interval),
            span(one.persons_between),
            one.scale_sd,
            one.shrinkage,
        );
    }
    text += "sd: standard deviation between persons on the scale of the fit; shrinkage: 0 by own presses alone, 1 by the population \
             alone\n\n";
    text += &format!("{:<18}{:>9}", "person", "presses");
    let names: String = found.population.iter().map(|one| format!("{:>34}", one.name)).collect();
    text += &format!("{names}\n");
    for person in &found.people {
        let own = |one: &PersonParameter| {
            format!("{:>34}", format!("{} ({}; {:.2})", figure(one.value), span(one.interval), one.shrinkage))
        };
        let own: String = person.parameters.iter().map(own).collect();
        text += &format!("{:<18}{:>9}{own}\n", person.code, person.human_actions);
    }
    text += "each with its 95 % interval and its shrinkage\n";
    text + &match &found.held_out {
        Some(held_out) => held_out.describe(),
        None => "\nheld out: nothing, since nobody has two trials\n".to_string(),
    }
}

/// A number as text with about three digits.
fn figure(value: f64) -> String {
    match value {
        value if value >= 100.0 => format!("{value:.0}"),
        value if value >= 10.0 => format!("{value:.1}"),
        value if value >= 1.0 => format!("{value:.2}"),
        value => format!("{value:.3}"),
    }
}

fn span([from, to]: [f64; 2]) -> String {
    format!("{} to {}", figure(from), figure(to))
}

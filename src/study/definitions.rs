//! Definitions of the terms that the report uses.

use super::rater_episodes::RULE;

pub(crate) const DEFINITIONS: &[(&str, &str)] = &[
    (
        "Regret, error",
        "Regret of a press: r(a) = 1 + C(s') - C(s), with the true state and recipes; C is the least number of presses of both \
         agents until all orders are served, proven to be the least; presses for which the proof exceeded its budget are counted. Error: r(a) exceeds the least regret among the human's presses by 1 or more, \
         unless the cost of an active order fell and the excess is at most 2. In about 2 % of presses no press of the human \
         helps (least regret 1); the excess is counted from there. An ineffective press is judged like any other.",
    ),
    ("Race", "A press within 300 ms of a robot change at the same place. It is flagged and not counted as an error."),
    (
        "Belief related error",
        "log p(a | b) - log p(a | truth) >= ln 3, with b, the human's belief, from before the press. Its aspect: the one whose \
         replacement by the truth lowers p(a | b) most; an order and its dish's recipe count as one target; where no single \
         aspect explains it, the best pair. Every other error is a slip. For simulated participants b is what they really \
         believed. For people b is only the assistant's estimate, so a headline result needs two raters' codes.",
    ),
    (
        "Error sequence",
        "Errors of the same false belief, at most 3 correct presses apart; an order and its dish's recipe are one false belief. \
         Errors about something else in between neither end nor lengthen it. Grouping whatever the aspect is stated second. \
         Length: number of errors. Recovery time: from the first error to the first correct press after the last. The paper's \
         3.1 errors per sequence is a number of related errors.",
    ),
    (
        "False belief episode",
        "From the time at which the belief about an aspect became false (P(truth) < 0.5) to its correction, if it caused an error.",
    ),
    ("False belief episode, of people", RULE),
    (
        "Similarity of wizard and assistant",
        "One-to-one matching in time within 3 human presses, at three levels: same signal and target, same kind of signal, any \
         signal then. The paper's 74 % (\u{201c}a similar decision \u{2026} in nearby time steps\u{201d}) is not defined further, so all \
         three stand side by side, each with its chance level. Trials in which the wizard saw the assistant's recommendations are not \
         part of it and stand beside it. The assistant's hypothetical signals follow from its counterfactual estimate, which leaves the wizard's signal out for as \
         many presses. The assistant does not repeat a hypothetical signal within the window, but may repeat it later. Recall \
         is of the wizard's signals, precision of the assistant's; kappa is per human press over {none, each signal and \
         target}; the chance levels are mean recalls after circular shifts. More frequent signals of an assistant raise \
         recall, so precision is stated too.",
    ),
    (
        "Errors prevented, useless signals",
        "Over unassisted trials in which false beliefs are known; the unit is the human press. Useful: an episode's first signal about its target, if at least one \
         belief related error of that target follows in the same episode. All other signals are useless: about what is believed \
         right, about a false but harmless belief, repeated, or after the last error, inside of episodes, too. True positive rate: \
         belief related errors prevented, of all; a signal prevents the later errors of its own aspect in the same episode, no \
         others, and replayed signals do not change b. False positive rate: useless signals per human press. For DEV, a proposal \
         of k presses after an error is one interruption; it spares the errors of the next k presses and is useless if none of \
         them would have been an error, belief related or not. Swept: cost 0.5 to 2.4, threshold 0.4 to 0.99, k 1 to 5; cost \
         also beyond that, so that ToM-Com reaches the compared numbers of signals. Compared at equal interruptions \
         per 100 presses of the human (linear interpolation between swept points and no signals), and as partial area over the \
         false positive rates that all concepts reach, divided by that range; intervals of 95 % by bootstrap over participants, \
         the area over the common range of each resample.",
    ),
    (
        "Offline and live",
        "Offline: what a concept's signals would have prevented in unassisted trials. Live: the same concept acting by itself on the \
         same seeds, compared over the simulated trials that all arms have. A live signal is useful if a twin of the trial with the same random \
         streams, but without it and all later signals, makes more belief related errors about its target until the end of the episode; \
         of people nobody knows. Offline figures cannot know how a trial goes on after a \
         signal.",
    ),
    (
        "Probes",
        "The task freezes, and the participant says what it believes. An answer that differs from the truth at the freeze is a false belief; \
         \"I don't know\" is one, too. Main results: scheduled questions about locations and recipes, answered in time. Left out: questions \
         without an answer, probes that the wizard asked for, questions about what comes next. Every question weighs 1 / inclusion, the \
         inverse of the probability with which it was drawn (Horvitz and Thompson 1952): shares, areas under the ROC (each pair of a wrong and a right answer \
         weighs the product of both weights) and calibration are about everything that could have been asked. Log score: weighted mean of \
         ln p(answer); how often what is usual, last seen or true is answered is learned on the other participants. Intervals: bootstrap over \
         participants.",
    ),
    (
        "Orders",
        "Time per order: from its appearance to its serving. Additional presses: the summed regret of both agents' presses per \
         served order, since orders interleave. Experience: the effect of the period on press durations, from the same mixed \
         ANOVA as the effect of assistance. Where assistance is judged, belief related errors and sequences per 100 human presses \
         come first; lengths of sequences describe, because an episode that was prevented wholly cannot be seen.",
    ),
    (
        "Causes by kind of aspect",
        "Belief related errors about an order, a recipe, or another location. An error about an ordered dish counts for the order or \
         for the recipe by what was believed wrong at the press; where both were, or nobody knows, it counts for neither alone.",
    ),
    (
        "Condition of a trial",
        "A trial counts in the condition to which the plan assigned it, as randomised; without a plan, in that of its settings. A trial \
         that was carried out otherwise (the wizard was shown what the assistants would send, another concept) is a deviation: it is \
         listed, and the analysis by conditions as carried out stands beside. Similarity of wizard and assistant goes by what the \
         wizard saw, and concepts are compared on trials in which nobody could send signals.",
    ),
    (
        "Assistance effect",
        "Two periods, two starting groups: mixed ANOVA with period within and starting group between; the assistance effect is \
         the interaction, F = t\u{b2} of the group difference of the period differences, also for unequal groups. Sums of squares \
         are of type III (unweighted means of the groups), so that the effect of the period does not contain the assistance where \
         groups differ in size. The paper's coding, condition within, is also given; with type III it tests the same. Every test \
         states its number of participants and names those with recordings whom it leaves out. Pearson r of group (1: assisted in the second trial) and improvement; r > 0: \
         assistance helps. Exact permutation test of the improvements; Hodges-Lehmann estimate of half their shift, with the \
         interval of the Mann-Whitney test; Hedges' g of the shift. Errors are compared as rates per human press, since trials \
         differ in length.",
    ),
    (
        "Acceptance",
        "The participant's mean answer to the items about acceptance after assisted trials, reversed where agreement means \
         rejection, from 0 to 1: high above 2/3, medium above 7/12, undecided within 1/12 of the middle, low below.",
    ),
];

# Reads the tables of `tomcom study` with R alone.
#
#   Rscript read_tables.R sessions/study
#
# Prints the same as read_tables.py.

folder <- commandArgs(trailingOnly = TRUE)[1]
if (is.na(folder)) stop("usage: Rscript read_tables.R sessions/study")
if (!file.exists(file.path(folder, "trials.csv"))) {
  stop(folder, " has no trials.csv: name the folder with the tables, such as ", folder, "/study", call. = FALSE)
}
trials <- read.csv(file.path(folder, "trials.csv"), na.strings = "", stringsAsFactors = FALSE)
actions <- read.csv(file.path(folder, "actions.csv"), na.strings = "", stringsAsFactors = FALSE)

counted <- trials[tolower(trials$counts) %in% c("true", "1"), ]
for (condition in sort(unique(counted$planned_arm))) {
  rate <- counted$error_rate_human[counted$planned_arm == condition]
  cat(sprintf("error_rate_human %s: %.6f in %d trials\n", condition, mean(rate, na.rm = TRUE), sum(!is.na(rate))))
}

# One row for each participant, one column for each condition.
paired <- tapply(counted$error_rate_human, list(counted$participant, counted$planned_arm), mean, na.rm = TRUE)
if (all(c("none", "wizard") %in% colnames(paired))) {
  difference <- paired[, "wizard"] - paired[, "none"]
  difference <- difference[!is.na(difference)]
  cat(sprintf("paired_difference: %.6f over %d participants\n", mean(difference), length(difference)))
}

human <- actions[actions$agent == "human" & actions$recording %in% counted$recording, ]
cat("presses_human:", nrow(human), "\n")
causes <- table(human$cause)
for (cause in sort(as.character(names(causes)), method = "radix")) cat(sprintf("cause %s: %d\n", cause, causes[[cause]]))

# Reads a recording with R and jsonlite, without tomcom.
#
#   Rscript examples/read_recording.R sessions/2026-03-14-P07-1
#
# Prints the same as read_recording.py of a recording with one part.

library(jsonlite)

folder <- commandArgs(trailingOnly = TRUE)[1]
if (is.na(folder)) stop("usage: Rscript read_recording.R sessions/2026-03-14-P07-1")
lines <- readLines(file.path(folder, "events.jsonl"), encoding = "UTF-8")
header <- fromJSON(lines[1], simplifyVector = FALSE)
if (!is.null(header$continues)) stop("a later part: the events before are in ", header$continues$recording)

# All events have a kind and a time; further fields are taken where they are needed.
field <- function(event, name) if (is.null(event[[name]])) NA else event[[name]]
events <- lapply(lines[-1], fromJSON, simplifyVector = FALSE)
kind <- vapply(events, field, "", "kind")
t_ns <- vapply(events, function(event) as.numeric(event$t_ns), 0)

# The trial's clock stands still in pauses.
clock <- rep(NA_real_, length(events))
running <- FALSE; started <- FALSE; since <- 0; before <- 0
for (row in seq_along(events)) {
  if (kind[row] %in% c("trial_started", "trial_resumed")) { running <- TRUE; started <- TRUE; since <- t_ns[row] }
  if (started) clock[row] <- (before + if (running) t_ns[row] - since else 0) / 1e9
  if (running && kind[row] %in% c("trial_paused", "trial_ended", "trial_aborted")) {
    running <- FALSE; before <- before + t_ns[row] - since
  }
}

pressed <- which(kind == "press")
agent <- vapply(events[pressed], field, "", "agent")
human <- pressed[agent == "human"]
buttons <- table(vapply(events[human], field, "", "button"))
cat("participant:", header$session$participant$code, "\n")
cat("condition:", header$session$trial$condition, "\n")
cat("events:", length(events), "\n")
cat("trial_s:", round(max(clock, na.rm = TRUE), 3), "\n")
cat("presses_human:", length(human), "\n")
cat("presses_robot:", sum(agent == "robot"), "\n")
cat("signals:", sum(kind == "signal_shown"), "\n")
cat("orders:", sum(kind == "order_shown"), "\n")
if (length(human) > 1) {
  cat("median_s_between_presses:", round(median(diff(clock[human])), 3), "\n")
  cat("most_pressed:", names(buttons)[which.max(buttons)], "\n")
}
gaze <- events[kind == "gaze"]
if (length(gaze) > 0) {
  number <- function(name) vapply(gaze, function(event) as.numeric(event[[name]]), 0)
  x <- number("x"); y <- number("y"); seen <- number("confidence") >= 0.6
  on_display <- x >= 0 & x <= 1 & y >= 0 & y <= 1
  cat("gaze_samples:", length(gaze), "\n")
  cat("gaze_on_display:", round(mean(on_display[seen]), 3), "\n")
}

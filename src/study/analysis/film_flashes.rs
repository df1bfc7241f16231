//! Alignment of a film with a recording by the flashes of the participant's page: a dark square that lights for
//! [`FLASH_S`] at the start and the end of the trial and at signals, at times that the log has.
//!
//! The square can be anywhere in the film. [`FlashSearch`] takes the film frame by frame and keeps, for each pixel, when
//! its brightness rose, stayed up for as long as a flash, and fell back. [`align`] finds the pixel whose flashes fit the
//! log's, and fits offset and drift of the film's clock to them.

use super::film_clock::frame_s;

/// Duration of a flash of the page, in seconds.
pub const FLASH_S: f64 = 0.2;
/// Least rise in brightness that counts as a flash, of 255.
const LEAST_RISE: u8 = 8;
/// By how much a flash may last longer or shorter than it should, in seconds and in frames: the page is drawn in steps.
const DURATION_TOLERANCE: (f64, f64) = (0.03, 1.2);
/// Time after which a rise is no flash any more, in seconds.
const LONGEST_RISE_S: f64 = 0.45;
/// Flashes of a pixel beyond which it is not a square on a page, but a lamp or a crowd.
const MOST_FLASHES: usize = 2000;
/// Standard deviation of the drift of cameras' clocks that is assumed before the flashes are seen, and largest drift.
const DRIFT_SD: f64 = 100e-6;
const MOST_DRIFT: f64 = 600e-6;
/// Pixels that are looked at closely, those with most support first.
const CLOSELY: usize = 200;
/// By how much brightness and contrast of flashes of one square differ at most, as a share of the contrast.
const SAME_SQUARE: f64 = 0.4;

/// A rise and fall of a pixel's brightness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenFlash {
    /// When it began, in seconds in the film: half a frame before the first bright one, since it began between two.
    pub onset_s: f64,
    /// Time between these two frames, in seconds: a film can have frames of different length.
    pub between_s: f64,
    /// Brightness before and after it, and its rise, of 255.
    pub dark: u8,
    pub contrast: u8,
}

/// A rise of a pixel's brightness that may become a flash.
#[derive(Clone, Copy, Debug, Default)]
struct Rise {
    /// Number of the first brighter frame; 0: there is no rise.
    frame: u32,
    dark: u8,
    first: u8,
    bright: u8,
}

/// Looks for flashes in a film, frame by frame.
#[derive(Clone, Debug, Default)]
pub struct FlashSearch {
    times_s: Vec<f64>,
    before: Vec<u8>,
    rises: Vec<Rise>,
    seen: Vec<Vec<SeenFlash>>,
}

impl FlashSearch {
    /// Takes the next frame: its time in the film, and the brightness of its pixels, whose number stays the same.
    pub fn take(&mut self, time_s: f64, pixels: &[u8]) {
        let frame = self.times_s.len();
        self.times_s.push(time_s);
        if frame == 0 {
            self.before = pixels.to_vec();
            self.rises = vec![Rise::default(); pixels.len()];
            self.seen = vec![Vec::new(); pixels.len()];
            return;
        }
        for (index, (&now, before)) in pixels.iter().zip(&mut self.before).enumerate() {
            let was = std::mem::replace(before, now);
            let rise = &mut self.rises[index];
            if rise.frame == 0 {
                if now >= was.saturating_add(LEAST_RISE) {
                    *rise = Rise { frame: frame as u32, dark: was, first: now, bright: now };
                }
                continue;
            }
            let began = rise.frame as usize;
            // A rise can take two frames.
            if frame == began + 1 {
                rise.bright = rise.bright.max(now);
            }
            let contrast = rise.bright - rise.dark;
            let half = rise.dark + contrast / 2;
            if now >= half {
                if time_s - self.times_s[began] > LONGEST_RISE_S {
                    rise.frame = 0;
                }
                continue;
            }
            let onset = if rise.first >= half { began } else { began + 1 };
            let fell_back = f64::from(now) > f64::from(rise.dark) - f64::from(contrast) / 2.0;
            let found = *rise;
            rise.frame = 0;
            if fell_back && onset < frame {
                let flash_s = time_s - self.times_s[onset];
                let frame_s = (time_s - self.times_s[onset - 1]) / (frame - onset + 1) as f64;
                let (seconds, frames) = DURATION_TOLERANCE;
                let flashes = &mut self.seen[index];
                if (flash_s - FLASH_S).abs() <= seconds + frames * frame_s && flashes.len() < MOST_FLASHES {
                    // Screen recorders have no frames while nothing changes: a long gap before the flash says nothing.
                    let [before_s, bright_s, after_s] = [onset - 1, onset, onset + 1].map(|at| self.times_s[at]);
                    let between_s = (bright_s - before_s).min(after_s - bright_s);
                    let onset_s = bright_s - between_s / 2.0;
                    flashes.push(SeenFlash { onset_s, between_s, dark: found.dark, contrast });
                }
            }
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.times_s.len()
    }

    /// Time of the first and of the last frame, in seconds.
    pub fn span_s(&self) -> [f64; 2] {
        [self.times_s.first(), self.times_s.last()].map(|time| time.copied().unwrap_or(0.0))
    }

    /// Median time between frames, in seconds.
    pub fn frame_s(&self) -> f64 {
        frame_s(&self.times_s)
    }
}

/// How session time and the film's time belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmAlignment {
    /// Time in the film of session time 0, in seconds.
    pub offset_s: f64,
    /// Share by which the film's clock goes faster than session time.
    pub drift: f64,
    /// Largest distance of a flash from where the alignment puts it, in seconds.
    pub residual_s: f64,
    /// Number of flashes that fit.
    pub flashes: usize,
}

/// Why a film was not aligned.
#[derive(Clone, Debug, PartialEq)]
pub enum AlignmentRefusal {
    /// No pixel flashes.
    NoFlash,
    /// Times of the flashes in the film that look most like those of the page, in seconds, and how many fit the log.
    FewFit { seen_s: Vec<f64>, fit: usize },
    /// The flashes fit only by more than a frame.
    Residual { residual_s: f64, flashes: usize },
}

/// Aligns a film by the times (in seconds, rising) at which the page drew its flashes.
pub fn align(search: &FlashSearch, drawn_s: &[f64]) -> Result<FilmAlignment, AlignmentRefusal> {
    let frame_s = search.frame_s();
    let mut pixels: Vec<(usize, u32, &[SeenFlash])> = Vec::new();
    for seen in search.seen.iter().filter(|seen| !seen.is_empty()) {
        let contrast = seen.iter().map(|flash| u32::from(flash.contrast)).max().unwrap_or(0);
        pixels.push((votes(seen, drawn_s, 4.0 * frame_s), contrast, seen));
    }
    pixels.sort_by_key(|(votes, contrast, _)| std::cmp::Reverse((*votes, *contrast)));
    let Some(likeliest) = pixels
        .iter()
        .map(|(_, contrast, seen)| (squareness(seen), *contrast, *seen))
        .max_by_key(|(score, contrast, _)| (*score, *contrast))
    else {
        return Err(AlignmentRefusal::NoFlash);
    };
    let try_pixel = |seen: &[SeenFlash]| align_pixel(seen, drawn_s, search.span_s(), frame_s);
    let closely = pixels.iter().take(CLOSELY);
    let mut found: Vec<FilmAlignment> = closely.filter_map(|(_, _, seen)| try_pixel(seen).ok()).collect();
    // The refusal of a film describes the pixel that looks most like the page's square.
    let refusal = || match try_pixel(likeliest.2) {
        Err(refusal) => refusal,
        Ok(alignment) => {
            let seen_s = likeliest.2.iter().map(|flash| flash.onset_s).collect();
            AlignmentRefusal::FewFit { seen_s, fit: alignment.flashes }
        }
    };
    // Of pixels with as many flashes the first has the highest contrast.
    let most = found.iter().map(|alignment| alignment.flashes).max().unwrap_or(0);
    found.retain(|alignment| alignment.flashes == most);
    let Some(best) = found.first().cloned() else { return Err(refusal()) };
    let middle_s = drawn_s[drawn_s.len() / 2];
    let at = |alignment: &FilmAlignment| alignment.offset_s + middle_s * (1.0 + alignment.drift);
    // Where several alignments are as good, none is known to be right.
    if found.iter().any(|other| (at(other) - at(&best)).abs() > 2.0 * frame_s + 2.0 * best.residual_s) {
        return Err(refusal());
    }
    Ok(best)
}

/// How much a pixel's flashes look like those of one square: the number of those of about the same brightness and contrast,
/// less the others.
fn squareness(seen: &[SeenFlash]) -> i64 {
    let median = |of: fn(&SeenFlash) -> u8| {
        let mut values: Vec<u8> = seen.iter().map(of).collect();
        values.sort_unstable();
        f64::from(values[values.len() / 2])
    };
    let (dark, contrast) = (median(|flash| flash.dark), median(|flash| flash.contrast));
    let is_like = |flash: &&SeenFlash| {
        let is_near = |value: u8, middle: f64| (f64::from(value) - middle).abs() <= SAME_SQUARE * contrast;
        is_near(flash.dark, dark) && is_near(flash.contrast, contrast)
    };
    let like = seen.iter().filter(is_like).count() as i64;
    like - 3 * (seen.len() as i64 - like)
}

/// Number of flashes that lie about equally far from flashes of the log.
fn votes(seen: &[SeenFlash], drawn_s: &[f64], width_s: f64) -> usize {
    let mut distances: Vec<f64> =
        seen.iter().flat_map(|flash| drawn_s.iter().map(move |drawn| flash.onset_s - drawn)).collect();
    distances.sort_by(f64::total_cmp);
    let mut first = 0;
    let mut most = 0;
    for (last, distance) in distances.iter().enumerate() {
        while distance - distances[first] > width_s {
            first += 1;
        }
        most = most.max(last - first + 1);
    }
    most.min(seen.len()).min(drawn_s.len())
}

/// Aligns by the flashes of one pixel.
fn align_pixel(
    seen: &[SeenFlash],
    drawn_s: &[f64],
    span_s: [f64; 2],
    frame_s: f64,
) -> Result<FilmAlignment, AlignmentRefusal> {
    let mut best: Vec<(f64, SeenFlash)> = Vec::new();
    for flash in seen {
        for &anchor in drawn_s {
            let fits = matched(seen, drawn_s, frame_s, (anchor, flash.onset_s));
            if fits.len() > best.len() {
                best = fits;
            }
        }
    }
    let few = || AlignmentRefusal::FewFit { seen_s: seen.iter().map(|flash| flash.onset_s).collect(), fit: best.len() };
    if best.len() < 2 {
        return Err(few());
    }
    let found = fit(&best, frame_s);
    let at = |drawn: f64| found.offset_s + drawn * (1.0 + found.drift);
    // Flashes of the log outside of the film, and flashes of the film before and after the trial, say nothing.
    let in_film = drawn_s.iter().filter(|&&drawn| at(drawn) > span_s[0] && at(drawn) + FLASH_S < span_s[1]).count();
    let number = best.len() as f64;
    let mean = |of: fn(&SeenFlash) -> u8| best.iter().map(|(_, flash)| f64::from(of(flash))).sum::<f64>() / number;
    let (dark, contrast) = (mean(|flash| flash.dark), mean(|flash| flash.contrast));
    let is_near = |value: u8, mean: f64| (f64::from(value) - mean).abs() <= SAME_SQUARE * contrast;
    let is_of_square = |flash: &SeenFlash| is_near(flash.dark, dark) && is_near(flash.contrast, contrast);
    let ends = [drawn_s.first(), drawn_s.last()].map(|drawn| at(drawn.copied().unwrap_or(0.0)));
    let of_square: Vec<f64> = seen.iter().filter(|flash| is_of_square(flash)).map(|flash| flash.onset_s).collect();
    let between =
        of_square.iter().filter(|&&onset_s| onset_s > ends[0] - frame_s && onset_s < ends[1] + frame_s).count();
    let strange = between.saturating_sub(best.len());
    let is_one_square = best.iter().all(|(_, flash)| is_of_square(flash));
    // Two flashes fit by chance more easily than several: they must be most of the log's, or all that there is in the film.
    let is_most = 2 * best.len() > drawn_s.len();
    let is_all = best.len() == in_film && best.len() == of_square.len();
    let is_enough = 2 * best.len() > in_film && (is_most || is_all || best.len() > 2);
    if !is_enough || 4 * strange > best.len() || !is_one_square {
        return Err(few());
    }
    let longest_s = best.iter().map(|(_, flash)| flash.between_s).fold(frame_s, f64::max);
    if found.residual_s > longest_s {
        return Err(AlignmentRefusal::Residual { residual_s: found.residual_s, flashes: found.flashes });
    }
    Ok(found)
}

/// Flashes of the log with the flash of the film that fits, if this flash of the log is that of the film.
fn matched(seen: &[SeenFlash], drawn_s: &[f64], frame_s: f64, anchor: (f64, f64)) -> Vec<(f64, SeenFlash)> {
    let fitting = |&drawn: &f64| {
        let wanted = anchor.1 + (drawn - anchor.0);
        let after = seen.partition_point(|flash| flash.onset_s < wanted);
        let near = seen[after.saturating_sub(1)..].iter().take(2);
        let near = near.min_by(|a, b| (a.onset_s - wanted).abs().total_cmp(&(b.onset_s - wanted).abs()))?;
        let tolerance = 1.5 * frame_s + MOST_DRIFT * (drawn - anchor.0).abs();
        ((near.onset_s - wanted).abs() <= tolerance).then_some((drawn, *near))
    };
    drawn_s.iter().filter_map(fitting).collect()
}

/// Least squares for the offset; the drift has a normal prior, since few flashes a few seconds apart cannot tell it: each
/// onset is known up to a frame.
fn fit(pairs: &[(f64, SeenFlash)], frame_s: f64) -> FilmAlignment {
    let number = pairs.len() as f64;
    let mean_drawn = pairs.iter().map(|(drawn, _)| drawn).sum::<f64>() / number;
    let mean_distance = pairs.iter().map(|(drawn, flash)| flash.onset_s - drawn).sum::<f64>() / number;
    let spread: f64 = pairs.iter().map(|(drawn, _)| (drawn - mean_drawn).powi(2)).sum();
    let common = pairs.iter().map(|(drawn, flash)| (drawn - mean_drawn) * (flash.onset_s - drawn - mean_distance));
    let variance = frame_s * frame_s / 12.0;
    let weight = spread + variance / (DRIFT_SD * DRIFT_SD);
    let drift = if weight > 0.0 { common.sum::<f64>() / weight } else { 0.0 };
    let offset_s = mean_distance - drift * mean_drawn;
    let residual = |(drawn, flash): &(f64, SeenFlash)| (flash.onset_s - offset_s - drawn * (1.0 + drift)).abs();
    let residual_s = pairs.iter().map(residual).fold(0.0, f64::max);
    FilmAlignment { offset_s, drift, residual_s, flashes: pairs.len() }
}

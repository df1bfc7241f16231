//! Gaze from any other program: lines {"t": seconds, "x": 0..1, "y": 0..1, "confidence": 0..1} over TCP or UDP on
//! localhost. Coordinates are fractions of the wall display, the origin at the top left; t is the tracker's own clock.
//! Lines that are no samples are counted.

use std::io;
use std::net::Ipv4Addr;

use serde::Deserialize;
use tokio::io::AsyncReadExt;
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::gaze_input::{GazeNews, WAITING};
use crate::gaze::GazeSample;

/// A line may be so long, in bytes.
const MAX_LINE: usize = 4096;
/// And a datagram, with one line or several.
const MAX_DATAGRAM: usize = 1 << 16;

#[derive(Deserialize)]
struct Line {
    #[serde(default)]
    t: Option<f64>,
    x: f64,
    y: f64,
    confidence: f64,
}

/// Listens on this port of localhost, for connections and for datagrams; trackers may come and go.
///
/// # Errors
/// The port cannot be listened on.
pub async fn listen(port: u16) -> io::Result<Receiver<GazeNews>> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await?;
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, port)).await?;
    let (sender, receiver) = channel(WAITING);
    tokio::spawn(take_datagrams(socket, sender.clone()));
    tokio::spawn(async move {
        while !sender.is_closed() {
            match listener.accept().await {
                Ok((stream, _)) => drop(tokio::spawn(read(stream, sender.clone()))),
                // Out of sockets, or the like: try again, but not in a hot loop.
                Err(_) => tokio::time::sleep(std::time::Duration::from_millis(100)).await,
            }
        }
    });
    Ok(receiver)
}

/// Reads datagrams for ever; what nobody takes in time is counted.
async fn take_datagrams(socket: UdpSocket, news: Sender<GazeNews>) {
    let mut buffer = vec![0; MAX_DATAGRAM];
    let (mut lost, mut from) = (0, None);
    while !news.is_closed() {
        let Ok((count, sender)) = socket.recv_from(&mut buffer).await else {
            // Somebody who sent has gone: that is told here, and nothing else.
            tokio::time::sleep(std::time::Duration::from_millis(1)).await;
            continue;
        };
        let began = (from.replace(sender) != Some(sender)).then_some(GazeNews::Began);
        let found = buffer[..count].split(|&byte| byte == b'\n').filter_map(parse);
        for news_of in began.into_iter().chain(found) {
            lost += u64::from(news.try_send(news_of).is_err());
        }
        if lost > 0 && news.try_send(GazeNews::Overrun(lost)).is_ok() {
            lost = 0;
        }
    }
}

/// Reads lines until the tracker goes; one that never ends a line cannot fill the memory. One that sends faster than it is
/// read has to wait.
async fn read(mut stream: TcpStream, news: Sender<GazeNews>) {
    let mut buffer = vec![0; MAX_LINE];
    let mut line: Vec<u8> = Vec::new();
    let mut too_long = false;
    if news.send(GazeNews::Began).await.is_err() {
        return;
    }
    while let Ok(count @ 1..) = stream.read(&mut buffer).await {
        for &byte in &buffer[..count] {
            match byte {
                b'\n' => {
                    let found = if too_long { Some(GazeNews::Malformed(1)) } else { parse(&line) };
                    line.clear();
                    too_long = false;
                    if let Some(found) = found
                        && news.send(found).await.is_err()
                    {
                        return;
                    }
                }
                _ if line.len() < MAX_LINE => line.push(byte),
                _ => too_long = true,
            }
        }
    }
    // A sender may end without ending its last line.
    if let Some(found) = parse(&line).filter(|_| !too_long) {
        let _ = news.send(found).await;
    }
}

/// What a line says; nothing for an empty one.
pub fn parse(line: &[u8]) -> Option<GazeNews> {
    if line.trim_ascii().is_empty() {
        return None;
    }
    let Ok(found) = serde_json::from_slice::<Line>(line) else { return Some(GazeNews::Malformed(1)) };
    // Beside the display is a place, too; a confidence beyond its scale is a tracker that speaks another language.
    if !(found.x.is_finite() && found.y.is_finite() && (0.0..=1.0).contains(&found.confidence)) {
        return Some(GazeNews::Malformed(1));
    }
    let device_ns = found.t.filter(|t| (0.0..1e10).contains(t)).map(|t| (t * 1e9).round() as u64);
    let sample = GazeSample { device_ns, ..GazeSample::new(found.x, found.y, found.confidence) };
    Some(GazeNews::Sample(sample, None))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::io::AsyncWriteExt;

    #[tokio::test]
    async fn samples_arrive_and_what_is_none_is_counted() {
        // Port 0: the system chooses; so the test listens itself.
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let (sender, mut lines) = channel(WAITING);
        let reader = tokio::spawn(async move {
            let (stream, _) = listener.accept().await.expect("a tracker");
            read(stream, sender).await;
        });
        let mut tracker = TcpStream::connect(address).await.expect("connected");
        let text = [
            "{\"t\": 1.5, \"x\": 0.25, \"y\": 0.5, \"confidence\": 0.9}\n",
            "\n{\"x\": 0.1, \"y\": 2, \"confidence\": 0, \"more\": 1}\r\n",
            "{\"x\": 0.5, \"y\": 0.5, \"confidence\": 1.01}\n{\"x\": 0.5, \"y\": 0.5, \"confidence\": -0.1}\n",
            "{\"x\": NaN, \"y\": 2, \"confidence\": 1}\nnonsense\n",
            &"9".repeat(3 * MAX_LINE),
            "\n{\"x\": 1e999, \"y\": 0, \"confidence\": 1}\n",
        ];
        tracker.write_all(text.concat().as_bytes()).await.expect("sent");
        drop(tracker);
        reader.await.expect("the reader ends with its tracker");
        let mut found = Vec::new();
        while let Some(line) = lines.recv().await {
            found.push(line);
        }
        let sample = |x, y, confidence, device_ns| {
            GazeNews::Sample(GazeSample { device_ns, ..GazeSample::new(x, y, confidence) }, None)
        };
        assert_eq!(found.remove(0), GazeNews::Began);
        let expected = [sample(0.25, 0.5, 0.9, Some(1_500_000_000)), sample(0.1, 2.0, 0.0, None)];
        assert_eq!(found[..2], expected);
        assert_eq!(found[2..], vec![GazeNews::Malformed(1); 6]);
    }
}

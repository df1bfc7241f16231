//! Server to which Rerun's viewers connect. The server speaks Rerun's protocol (gRPC, and gRPC-Web for viewers in a
//! browser), but only provides data: clients that send data are refused.
//!
//! The server in Rerun's SDK is not suitable. That server accepts messages from everybody who reaches its port and
//! shows them to all viewers; a stopped viewer blocks the stream, and the data that the viewer has not read stay in
//! memory besides the history. Here each viewer reads from its own position in the kept messages (`kept_messages.rs`):
//! a slow or stopped viewer delays nobody, takes no memory of its own, and misses only what has been removed meanwhile.

use std::io;
use std::net::SocketAddr;
use std::pin::{Pin, pin};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use futures::stream::{self, Stream};
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto;
use hyper_util::service::TowerToHyperService;
use re_protos::log_msg::v1alpha1::{self as messages, log_msg::Msg};
use re_protos::sdk_comms::v1alpha1::message_proxy_service_server::{MessageProxyService, MessageProxyServiceServer};
use re_protos::sdk_comms::v1alpha1::{
    ReadMessagesRequest, ReadMessagesResponse, ReadTablesRequest, ReadTablesResponse, WriteMessagesRequest,
    WriteMessagesResponse, WriteTableRequest, WriteTableResponse,
};
use re_sdk::SizeBytes;
use re_sdk::StoreId;
use re_sdk::external::re_grpc_server::cors_layer;
use re_sdk::external::re_log_encoding::rrd::Compression;
use re_sdk::external::re_log_encoding::{ToApplication, ToTransport};
use re_sdk::log::{Chunk, LogMsg};
use re_sdk::sink::{LogSink, SinkFlushError};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tonic::{Request, Response, Status};
use tonic_web::GrpcWebLayer;
use tower_layer::Layer;

use super::kept_messages::KeptMessages;
use crate::host_name::is_local;

/// Largest number of viewers' connections at a time; further connections are closed at once.
const MOST_CONNECTIONS: usize = 32;
/// Time limit for the first request of a viewer's connection.
const ASKS: Duration = Duration::from_secs(5);
/// Period of checking whether a viewer still responds, and time limit for the viewer's response: a stopped viewer does
/// not respond.
const PING: Duration = Duration::from_secs(10);
const PONG: Duration = Duration::from_secs(20);
/// Time that viewers have to read the rest of the stream after its end.
const LAST: Duration = Duration::from_secs(1);
/// Pause after a failure to accept a connection, such as too many open files.
const AGAIN: Duration = Duration::from_millis(100);
/// Memory that a kept message takes besides its data, in bytes: the entries of its number and its entity.
const OVERHEAD: usize = 512;

/// State that the stream and all connected viewers share.
struct SharedStream {
    /// Messages in the compressed form that viewers receive: in the SDK's form, each has an Arrow schema in memory.
    kept: Mutex<KeptMessages<Msg>>,
    /// Number of messages of the stream so far; the channel closes at the end of the stream.
    told: watch::Receiver<u64>,
}

/// Provides a stream to viewers until this value is dropped.
pub(super) struct ViewerServer {
    shared: Arc<SharedStream>,
    tell: watch::Sender<u64>,
}

impl ViewerServer {
    /// Listens at this address; at most `most_bytes` bytes are kept for viewers that connect later.
    ///
    /// # Errors
    /// The program cannot listen at the address.
    pub fn open(address: SocketAddr, most_bytes: usize) -> io::Result<ViewerServer> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let (tell, told) = watch::channel(0);
        let shared = Arc::new(SharedStream { kept: Mutex::new(KeptMessages::new(most_bytes, merged)), told });
        let service = ViewerService(shared.clone());
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        std::thread::Builder::new().name("viewers".to_string()).spawn(move || {
            runtime.block_on(async {
                let over = over(service.0.told.clone());
                tokio::select! {
                    _ = serve(listener, address.ip().is_loopback(), service) => {}
                    () = over => tokio::time::sleep(LAST).await,
                }
            });
        })?;
        Ok(ViewerServer { shared, tell })
    }
}

/// Waits until the stream ends.
async fn over(mut told: watch::Receiver<u64>) {
    while told.changed().await.is_ok() {}
}

impl LogSink for ViewerServer {
    fn send(&self, message: LogMsg) {
        let Ok(encoded) = message.to_transport(Compression::LZ4) else { return };
        let bytes = bytes(&encoded);
        let chunk = match &message {
            LogMsg::ArrowMsg(store, data) if store.is_recording() => Chunk::from_arrow_msg(data).ok(),
            _ => None,
        };
        let mut kept = self.shared.lock();
        match chunk {
            Some(chunk) if !chunk.is_static() => kept.add(encoded, bytes, &chunk.entity_path().to_string()),
            // The recording's name and the viewer's layout have no chunk.
            timeless => kept.add_timeless(encoded, bytes, timeless.map(|chunk| said(&chunk))),
        }
        drop(kept);
        self.tell.send_modify(|told| *told += 1);
    }

    fn flush_blocking(&self, _: Duration) -> Result<(), SinkFlushError> {
        Ok(())
    }
}

/// The entity and the components that a chunk is about.
fn said(chunk: &Chunk) -> String {
    let mut components: Vec<String> = chunk.components().keys().map(|component| component.to_string()).collect();
    components.sort();
    format!("{} {}", chunk.entity_path(), components.join(" "))
}

/// Memory that a kept message takes, in bytes.
fn bytes(message: &Msg) -> usize {
    OVERHEAD + message.total_size_bytes() as usize
}

/// Merges pieces (chunks) of one entity into one.
fn merged(pieces: &[Msg]) -> Option<(Msg, usize)> {
    let mut chunks = Vec::new();
    let mut recording = None;
    for piece in pieces {
        let Msg::ArrowMsg(data) = piece else { return None };
        recording = data.store_id.clone();
        chunks.push(Chunk::from_arrow_msg(&data.to_application(()).ok()?).ok()?);
    }
    while chunks.len() > 1 {
        let pairs = chunks.chunks(2).map(|pair| match pair {
            [left, right] => Chunk::concat_and_sort(left, right).ok(),
            single => single.first().cloned(),
        });
        chunks = pairs.collect::<Option<Vec<Chunk>>>()?;
    }
    let recording = StoreId::try_from(recording?).ok()?;
    let message = chunks.first()?.to_arrow_msg().ok()?.to_transport((recording, Compression::LZ4)).ok()?;
    let message = Msg::ArrowMsg(message);
    let bytes = bytes(&message);
    Some((message, bytes))
}

impl SharedStream {
    fn lock(&self) -> MutexGuard<'_, KeptMessages<Msg>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The first message whose number is at least `from`, with the message's number; waits if there is none yet. `None`
    /// at the end of the stream.
    async fn next(&self, from: u64) -> Option<(u64, Msg)> {
        let mut told = self.told.clone();
        loop {
            told.mark_unchanged();
            let next = self.lock().next(from);
            if next.is_some() {
                return next;
            }
            told.changed().await.ok()?;
        }
    }
}

/// Rerun's gRPC service for reading the messages of a stream.
#[derive(Clone)]
struct ViewerService(Arc<SharedStream>);

/// A gRPC response that consists of many messages.
type Answers<T> = Pin<Box<dyn Stream<Item = Result<T, Status>> + Send>>;

fn read_only<T>() -> Result<Response<T>, Status> {
    Err(Status::permission_denied("this stream is for reading only: tomcom takes no messages from others"))
}

#[tonic::async_trait]
impl MessageProxyService for ViewerService {
    type ReadMessagesStream = Answers<ReadMessagesResponse>;
    type ReadTablesStream = Answers<ReadTablesResponse>;

    async fn read_messages(
        &self,
        _: Request<ReadMessagesRequest>,
    ) -> Result<Response<Self::ReadMessagesStream>, Status> {
        let shared = self.0.clone();
        let answers = stream::unfold(0, move |from| {
            let shared = shared.clone();
            async move {
                let (number, message) = shared.next(from).await?;
                let log_msg = Some(messages::LogMsg { msg: Some(message) });
                Some((Ok(ReadMessagesResponse { log_msg }), number + 1))
            }
        });
        Ok(Response::new(Box::pin(answers)))
    }

    async fn read_tables(&self, _: Request<ReadTablesRequest>) -> Result<Response<Self::ReadTablesStream>, Status> {
        Ok(Response::new(Box::pin(stream::pending())))
    }

    async fn write_messages(
        &self,
        _: Request<tonic::Streaming<WriteMessagesRequest>>,
    ) -> Result<Response<WriteMessagesResponse>, Status> {
        read_only()
    }

    async fn write_table(&self, _: Request<WriteTableRequest>) -> Result<Response<WriteTableResponse>, Status> {
        read_only()
    }
}

/// Accepts connections of viewers until the server stops.
async fn serve(listener: std::net::TcpListener, is_loopback: bool, service: ViewerService) -> io::Result<()> {
    let listener = TcpListener::from_std(listener)?;
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok((connection, _)) = listener.accept().await else {
            tokio::time::sleep(AGAIN).await;
            continue;
        };
        let Ok(place) = places.clone().try_acquire_owned() else { continue };
        let service = service.clone();
        tokio::spawn(async move {
            answer(connection, is_loopback, service).await;
            drop(place);
        });
    }
}

/// Answers the requests of a viewer's connection until it ends. Errors of a connection do not affect the stream.
async fn answer(connection: TcpStream, is_loopback: bool, service: ViewerService) {
    let _ = connection.set_nodelay(true);
    let (asks, mut asked) = watch::channel(false);
    let asks = Arc::new(asks);
    let checked = MessageProxyServiceServer::with_interceptor(service, move |request: Request<()>| {
        asks.send_replace(true);
        if is_loopback { with_local_host(request) } else { Ok(request) }
    });
    let routes = tonic::service::Routes::new(checked).prepare();
    let answers = TowerToHyperService::new(cors_layer(&[]).layer(GrpcWebLayer::new().layer(routes)));
    let mut http = auto::Builder::new(TokioExecutor::new());
    http.http1().timer(TokioTimer::new()).header_read_timeout(ASKS);
    http.http2().timer(TokioTimer::new()).keep_alive_interval(PING).keep_alive_timeout(PONG);
    let mut served = pin!(http.serve_connection(TokioIo::new(connection), answers));
    tokio::select! {
        _ = served.as_mut() => return,
        asked = tokio::time::timeout(ASKS, asked.wait_for(|asked| *asked)) => if asked.is_err() { return },
    }
    let _ = served.await;
}

/// Refuses requests that a browser sends to this machine under another name: such requests come from a foreign website
/// (DNS rebinding).
fn with_local_host(request: Request<()>) -> Result<Request<()>, Status> {
    let host = request.metadata().get("host").map(|host| host.to_str().unwrap_or_default());
    match host.is_none_or(is_local) {
        true => Ok(request),
        false => Err(Status::permission_denied("this stream is for this machine only")),
    }
}

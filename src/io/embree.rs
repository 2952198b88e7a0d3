//! Embree, loaded when it is asked for: the rival of `bench` and a reference of the tests.
//!
//! Nothing is linked. [`Embree::load`] opens the shared library named by `EMBREE_LIB`, else
//! version 4, else version 3, and learns from the device which of the two calling conventions
//! to use. Embree works in f32, with absolute constants for lengths of about 1; scenes are
//! moved to the middle of their bounding box first and scaled by a power of two to a size
//! between 1 and 2, and rays with them, so that data of any size and place keep their digits.
//! Rays that begin far away are given from a point beside the scene on.
//!
//! Embree advises its users to flush denormal numbers to zero (MXCSR bits FTZ and DAZ) on
//! every tracing thread. We do not: the setting would change our own f64 arithmetic on the
//! same thread, and scenes of ordinary size meet no denormals.
//!
//! This is the only file of the crate with `unsafe` code. What it relies on are the layouts
//! and signatures of Embree's API documentation, versions 3.13 and 4.4; each is described
//! where it is declared.
#![allow(unsafe_code, reason = "calls into a C library; each use says why it is sound")]

use std::ffi::{CStr, CString, OsStr, c_char, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::{env, ptr};

use libloading::Library;

use super::embree_error::{EmbreeError, OVERRIDE, first_usable};
use super::embree_rays::{
    EmbreePart, EmbreePrimitive, EmbreeRays, PacketWidth, Packets, geometry_id,
};
use super::mesh::GridMesh;
use crate::intersect::Coherence;
use crate::math::{Aabb, Ray};
use crate::patch::ScaledFrame;

/// Library names to try, newest first; the plain names are those of development packages.
const NAMES: [&str; 4] = ["libembree4.so.4", "libembree3.so.3", "libembree4.so", "libembree3.so"];

// Embree's handles are pointers to types of its own. Pointers to `c_void` stand for them and
// for every structure passed; all pointers are passed alike.
type Handle = *mut c_void;
type NewDevice = unsafe extern "C" fn(*const c_char) -> Handle;
type DeviceProperty = unsafe extern "C" fn(Handle, i32) -> isize;
type DeviceError = unsafe extern "C" fn(Handle) -> i32;
type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;
type SetMonitor = unsafe extern "C" fn(Handle, Monitor, *mut c_void);
type Act = unsafe extern "C" fn(Handle);
type NewScene = unsafe extern "C" fn(Handle) -> Handle;
type SetFlags = unsafe extern "C" fn(Handle, i32);
type NewGeometry = unsafe extern "C" fn(Handle, i32) -> Handle;
/// Geometry, buffer type, slot, format, bytes an item, items.
type NewBuffer = unsafe extern "C" fn(Handle, i32, u32, i32, usize, usize) -> *mut c_void;
/// Scene, geometry, the number it gets.
type Attach = unsafe extern "C" fn(Handle, Handle, u32);
/// `rtcIntersect1` and `rtcOccluded1`.
/// Version 3 takes (scene, context, rays), version 4 (scene, rays, arguments).
type Single = unsafe extern "C" fn(Handle, *mut c_void, *mut c_void);
/// `rtcIntersect8` and the like: the same after the mask of valid lanes.
type Packet = unsafe extern "C" fn(*const i32, Handle, *mut c_void, *mut c_void);

// Numbers of RTCDeviceProperty, RTCGeometryType, RTCBufferType, RTCFormat and RTCSceneFlags,
// the same in versions 3 and 4.
const VERSION_MAJOR: i32 = 1;
const VERSION_MINOR: i32 = 2;
const VERSION_PATCH: i32 = 3;
const TRIANGLE_GEOMETRY: i32 = 0;
const GRID_GEOMETRY: i32 = 2;
const INDEX_BUFFER: i32 = 0;
const VERTEX_BUFFER: i32 = 1;
const GRID_BUFFER: i32 = 8;
const UINT3: i32 = 0x5003;
const FLOAT3: i32 = 0x9003;
const GRID: i32 = 0xA001;
const ROBUST: i32 = 1 << 2;

/// `RTCGrid`, 12 bytes: a rectangle of vertices, `width` along each row.
#[repr(C)]
#[derive(Clone, Copy)]
struct RtcGrid {
    first_vertex: u32,
    row_stride: u32,
    width: u16,
    height: u16,
}

/// What a query takes besides the rays; longer than either version needs in any build.
///
/// Version 3 reads `RTCIntersectContext`: flags, four bytes of padding, filter (none), then
/// the instance IDs of as many levels as Embree was built with, all invalid. Version 4 reads
/// `RTCIntersectArguments`: flags, feature mask (all), then context, filter and callbacks
/// (none).
#[repr(C)]
struct Options {
    flags: u32,
    features: u32,
    pointer: *mut c_void,
    tail: [u32; 32],
}

impl Options {
    fn new(major: u32, coherence: Coherence) -> Self {
        let (coherent, fill) = if major >= 4 { (1 << 16, 0) } else { (1, u32::MAX) };
        let flags = match coherence {
            Coherence::Coherent => coherent,
            Coherence::Incoherent => 0,
        };
        Self { flags, features: u32::MAX, pointer: ptr::null_mut(), tail: [fill; 32] }
    }
}

/// One kind of query at each packet width.
#[derive(Clone, Copy, Debug)]
struct Query {
    one: Single,
    eight: Packet,
    sixteen: Packet,
}

/// The functions used, valid while their library is open.
#[derive(Clone, Copy, Debug)]
struct Functions {
    new_device: NewDevice,
    release_device: Act,
    device_property: DeviceProperty,
    device_error: DeviceError,
    set_monitor: SetMonitor,
    new_scene: NewScene,
    set_scene_flags: SetFlags,
    commit_scene: Act,
    release_scene: Act,
    new_geometry: NewGeometry,
    new_buffer: NewBuffer,
    commit_geometry: Act,
    attach_geometry: Attach,
    release_geometry: Act,
    intersect: Query,
    occluded: Query,
}

impl Functions {
    fn find(library: &Library, path: &str) -> Result<Self, EmbreeError> {
        let library = (library, path);
        // SAFETY: the types above are those of Embree's C functions of these names.
        unsafe {
            Ok(Self {
                new_device: symbol(library, "rtcNewDevice")?,
                release_device: symbol(library, "rtcReleaseDevice")?,
                device_property: symbol(library, "rtcGetDeviceProperty")?,
                device_error: symbol(library, "rtcGetDeviceError")?,
                set_monitor: symbol(library, "rtcSetDeviceMemoryMonitorFunction")?,
                new_scene: symbol(library, "rtcNewScene")?,
                set_scene_flags: symbol(library, "rtcSetSceneFlags")?,
                commit_scene: symbol(library, "rtcCommitScene")?,
                release_scene: symbol(library, "rtcReleaseScene")?,
                new_geometry: symbol(library, "rtcNewGeometry")?,
                new_buffer: symbol(library, "rtcSetNewGeometryBuffer")?,
                commit_geometry: symbol(library, "rtcCommitGeometry")?,
                attach_geometry: symbol(library, "rtcAttachGeometryByID")?,
                release_geometry: symbol(library, "rtcReleaseGeometry")?,
                intersect: Query {
                    one: symbol(library, "rtcIntersect1")?,
                    eight: symbol(library, "rtcIntersect8")?,
                    sixteen: symbol(library, "rtcIntersect16")?,
                },
                occluded: Query {
                    one: symbol(library, "rtcOccluded1")?,
                    eight: symbol(library, "rtcOccluded8")?,
                    sixteen: symbol(library, "rtcOccluded16")?,
                },
            })
        }
    }
}

/// Finds a function by name.
///
/// # Safety
/// `F` must be the type of that function, and must not be called once the library is closed.
unsafe fn symbol<F: Copy>((library, path): (&Library, &str), name: &str) -> Result<F, EmbreeError> {
    // SAFETY: as this function demands of its caller.
    unsafe { library.get::<F>(name.as_bytes()) }
        .map(|found| *found)
        .map_err(|_| EmbreeError::Symbol { library: path.to_owned(), symbol: name.to_owned() })
}

/// An open device.
#[derive(Debug)]
struct Device {
    handle: Handle,
    functions: Functions,
    version: [u32; 3],
    /// Bytes held by Embree; shared with the device, which knows where they are.
    bytes: Arc<AtomicIsize>,
}

// SAFETY: Embree's calls on devices and on committed scenes are thread-safe by its
// documentation, and the count of bytes is atomic.
unsafe impl Send for Device {}
// SAFETY: as for `Send`.
unsafe impl Sync for Device {}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the device is open, and its scenes are gone: each keeps it alive.
        unsafe { (self.functions.release_device)(self.handle) }
    }
}

impl Device {
    fn open(library: Library, path: &str, config: &CStr) -> Result<Self, EmbreeError> {
        let functions = Functions::find(&library, path)?;
        let bytes = Arc::new(AtomicIsize::new(0));
        let counter = Arc::as_ptr(&bytes);

        // SAFETY: `config` ends in a zero. A null device has an error code of its own.
        let (handle, code) = unsafe {
            let handle = (functions.new_device)(config.as_ptr());
            (handle, (functions.device_error)(handle))
        };
        if handle.is_null() {
            return Err(EmbreeError::Refused { request: "open a device", code });
        }
        let mut device = Self { handle, functions, version: [0; 3], bytes };
        // The library stays open for good: closing it unmaps code that its worker threads,
        // which end in their own time, still run (seen as a crash with TBB).
        std::mem::forget(library);

        // SAFETY: the device is open, and `count_bytes` gets the counter that lives as long.
        let version = unsafe {
            (functions.set_monitor)(handle, count_bytes, counter.cast_mut().cast());
            [VERSION_MAJOR, VERSION_MINOR, VERSION_PATCH]
                .map(|property| (functions.device_property)(handle, property))
        };
        if !(3..=4).contains(&version[0]) {
            return Err(EmbreeError::Version { library: path.to_owned(), major: version[0] });
        }
        device.version = version.map(|number| u32::try_from(number).unwrap_or(0));
        Ok(device)
    }

    /// The first error since the last call, as a failure of `request`.
    fn check(&self, request: &'static str) -> Result<(), EmbreeError> {
        // SAFETY: the device is open.
        match unsafe { (self.functions.device_error)(self.handle) } {
            0 => Ok(()),
            code => Err(EmbreeError::Refused { request, code }),
        }
    }
}

/// Called by Embree when it takes memory or returns it.
///
/// # Safety
/// `counter` must point to a live `AtomicIsize`.
unsafe extern "C" fn count_bytes(counter: *mut c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: as this function demands of its caller; [`Device`] outlives its device.
    let counter = unsafe { &*counter.cast::<AtomicIsize>() };
    counter.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// Embree, ready to build scenes. Cloning shares the device.
#[derive(Clone, Debug)]
pub struct Embree {
    device: Arc<Device>,
}

impl Embree {
    /// Loads Embree, to build scenes with one thread a processor.
    ///
    /// # Errors
    /// When there is no library that can be opened, is Embree 3 or 4 and suits the processor; the
    /// message says what is wrong with each and how to install one.
    pub fn load() -> Result<Self, EmbreeError> {
        Self::open(c"")
    }

    /// Loads Embree, to build scenes with this many threads; 0 means one a processor.
    ///
    /// # Errors
    /// As [`Embree::load`].
    pub fn load_with_threads(threads: u16) -> Result<Self, EmbreeError> {
        let config = CString::new(format!("threads={threads}")).unwrap_or_default();
        Self::open(&config)
    }

    fn open(config: &CStr) -> Result<Self, EmbreeError> {
        if let Some(name) = env::var_os(OVERRIDE).filter(|name| !name.is_empty()) {
            return Self::open_one(&name, config);
        }
        first_usable(&NAMES, |name| Self::open_one(name.as_ref(), config))
    }

    /// Loads the library with this name.
    fn open_one(name: &OsStr, config: &CStr) -> Result<Self, EmbreeError> {
        // SAFETY: Embree's initialisers, and those of the libraries it needs, are sound;
        // what EMBREE_LIB names is the user's responsibility, as with LD_PRELOAD.
        let library = unsafe { Library::new(name) };
        let library =
            library.map_err(|error| EmbreeError::Missing { tried: vec![error.to_string()] })?;
        let device = Device::open(library, &name.to_string_lossy(), config)?;
        Ok(Self { device: Arc::new(device) })
    }

    /// The version loaded: major, minor, patch.
    pub fn version(&self) -> [u32; 3] {
        self.device.version
    }

    /// The memory Embree holds now, in bytes: hierarchies and its copies of the meshes.
    pub fn bytes(&self) -> usize {
        usize::try_from(self.device.bytes.load(Ordering::Relaxed)).unwrap_or(0)
    }

    /// Builds a scene; hits name the meshes by their place in the slice.
    ///
    /// # Errors
    /// When Embree refuses, for want of memory.
    pub fn scene(
        &self,
        meshes: &[GridMesh],
        primitive: EmbreePrimitive,
    ) -> Result<EmbreeScene, EmbreeError> {
        let positions = meshes.iter().flat_map(GridMesh::positions).copied();
        let frame = ScaledFrame::around(&Aabb::around(positions));
        let functions = &self.device.functions;

        // SAFETY: the device is open; a null scene is an error caught before it is used.
        let handle = unsafe { (functions.new_scene)(self.device.handle) };
        self.device.check("create a scene")?;
        let scene = EmbreeScene { handle, frame, device: Arc::clone(&self.device) };
        // SAFETY: the scene is open.
        unsafe { (functions.set_scene_flags)(handle, ROBUST) };
        for (number, mesh) in (0..).zip(meshes) {
            scene.attach_all(mesh, primitive, number)?;
        }
        // SAFETY: the scene is open, and nothing else uses it yet.
        unsafe { (functions.commit_scene)(handle) };
        self.device.check("build a scene")?;
        Ok(scene)
    }
}

/// Meshes in Embree's hierarchy.
#[derive(Debug)]
pub struct EmbreeScene {
    handle: Handle,
    frame: ScaledFrame,
    device: Arc<Device>,
}

// SAFETY: the scene is committed before anyone else sees it, and Embree answers queries on a
// committed scene from any number of threads.
unsafe impl Send for EmbreeScene {}
// SAFETY: as for `Send`.
unsafe impl Sync for EmbreeScene {}

impl Drop for EmbreeScene {
    fn drop(&mut self) {
        // SAFETY: the scene is open, and so is its device.
        unsafe { (self.device.functions.release_scene)(self.handle) }
    }
}

impl EmbreeScene {
    /// Copies a mesh into new geometries of the scene. Each gets the vertices that it uses.
    fn attach_all(
        &self,
        mesh: &GridMesh,
        primitive: EmbreePrimitive,
        number: u32,
    ) -> Result<(), EmbreeError> {
        let vertex = |at: usize| self.frame.scaled(mesh.positions()[at]).as_vec3().to_array();
        if primitive == EmbreePrimitive::Triangle {
            let vertices = (0..mesh.positions().len()).map(vertex);
            let id = geometry_id(number, EmbreePart::Triangle);
            let items = ((INDEX_BUFFER, UINT3), mesh.triangles());
            return self.attach(TRIANGLE_GEOMETRY, id, vertices, items);
        }
        if !mesh.grids().is_empty() {
            let (mut vertices, mut grids) = (Vec::new(), Vec::new());
            for grid in mesh.grids() {
                let (first, columns, rows) = (grid.first(), grid.columns(), grid.rows());
                grids.push(RtcGrid {
                    first_vertex: vertices.len() as u32,
                    row_stride: u32::from(columns),
                    width: columns,
                    height: rows,
                });
                let count = usize::from(columns) * usize::from(rows);
                vertices.extend((first as usize..).take(count).map(vertex));
            }
            let id = geometry_id(number, EmbreePart::Grid);
            let items = ((GRID_BUFFER, GRID), grids.into_iter());
            self.attach(GRID_GEOMETRY, id, vertices.into_iter(), items)?;
        }
        if !mesh.faces().is_empty() {
            let mut numbers = vec![u32::MAX; mesh.positions().len()];
            let mut vertices = Vec::new();
            let mut renumbered = |corner: u32| {
                let number = &mut numbers[corner as usize];
                if *number == u32::MAX {
                    *number = vertices.len() as u32;
                    vertices.push(vertex(corner as usize));
                }
                *number
            };
            let faces: Vec<_> = mesh.faces().iter().map(|face| face.map(&mut renumbered)).collect();
            let id = geometry_id(number, EmbreePart::Face);
            let items = ((INDEX_BUFFER, UINT3), faces.into_iter());
            self.attach(TRIANGLE_GEOMETRY, id, vertices.into_iter(), items)?;
        }
        Ok(())
    }

    /// Makes a new geometry of the scene from vertices and what they are vertices of.
    fn attach<T: Copy>(
        &self,
        kind: i32,
        id: u32,
        vertices: impl Iterator<Item = [f32; 3]>,
        (buffer, items): ((i32, i32), impl Iterator<Item = T>),
    ) -> Result<(), EmbreeError> {
        let functions = &self.device.functions;
        // SAFETY: the device is open.
        let geometry = unsafe { (functions.new_geometry)(self.device.handle, kind) };
        self.device.check("create a geometry")?;

        let filled = self.fill(geometry, (VERTEX_BUFFER, FLOAT3), vertices);
        let filled = filled.and_then(|()| self.fill(geometry, buffer, items));

        // SAFETY: geometry and scene are open; the scene keeps the geometry, we let go of it.
        unsafe {
            if filled.is_ok() {
                (functions.commit_geometry)(geometry);
                (functions.attach_geometry)(self.handle, geometry, id);
            }
            (functions.release_geometry)(geometry);
        }
        filled.and_then(|()| self.device.check("attach a geometry"))
    }

    /// Fills a new buffer of a geometry. `T` is what `format` says, with no padding.
    fn fill<T: Copy>(
        &self,
        geometry: Handle,
        (kind, format): (i32, i32),
        items: impl Iterator<Item = T>,
    ) -> Result<(), EmbreeError> {
        let items: Vec<T> = items.collect();
        let (size, count) = (size_of::<T>(), items.len());
        // SAFETY: the geometry is open; Embree allocates `count` items of `size` bytes, and
        // the padding it wants behind them, or returns null and reports an error.
        unsafe {
            let buffer = (self.device.functions.new_buffer)(geometry, kind, 0, format, size, count);
            if !buffer.is_null() {
                ptr::copy_nonoverlapping(items.as_ptr().cast::<u8>(), buffer.cast(), size * count);
            }
        }
        self.device.check("allocate a buffer")
    }

    /// Makes rays ready for this scene, in packets of the width given.
    ///
    /// Origins, directions and ranges are rounded to f32 in the scene's frame, after far origins
    /// have been moved along their rays to beside the scene; a range starts at 0 at the earliest.
    pub fn rays(&self, rays: &[Ray], width: PacketWidth, coherence: Coherence) -> EmbreeRays {
        EmbreeRays::new(rays, &self.frame, width, coherence)
    }

    /// Finds the first hit of each ray. May be repeated.
    pub fn intersect(&self, rays: &mut EmbreeRays) {
        self.run(self.device.functions.intersect, rays);
    }

    /// Finds out which rays are occluded. May be repeated.
    pub fn occluded(&self, rays: &mut EmbreeRays) {
        self.run(self.device.functions.occluded, rays);
    }

    fn run(&self, query: Query, rays: &mut EmbreeRays) {
        let major = self.device.version[0];
        let mut options = Options::new(major, rays.coherence());
        let options: *mut c_void = (&raw mut options).cast();
        let ordered =
            |rays: *mut c_void| if major >= 4 { (rays, options) } else { (options, rays) };

        // SAFETY: scene and options are open, each packet is an `RTCRayHitN` of the width the
        // function wants, aligned to 64 bytes, and its mask lies at a multiple of 4 N bytes.
        // For occlusion it is read as the `RTCRayN` it begins with.
        unsafe {
            match rays.packets_mut() {
                Packets::One(packets) => packets.iter_mut().for_each(|packet| {
                    packet.reset();
                    let (first, second) = ordered((&raw mut *packet).cast());
                    (query.one)(self.handle, first, second);
                }),
                Packets::Eight(packets) => packets.iter_mut().for_each(|packet| {
                    packet.reset();
                    let (first, second) = ordered((&raw mut *packet).cast());
                    (query.eight)((&raw const packet.valid).cast(), self.handle, first, second);
                }),
                Packets::Sixteen(packets) => packets.iter_mut().for_each(|packet| {
                    packet.reset();
                    let (first, second) = ordered((&raw mut *packet).cast());
                    (query.sixteen)((&raw const packet.valid).cast(), self.handle, first, second);
                }),
            }
        }
    }
}

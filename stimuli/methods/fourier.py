"""Fourier walks (Tilmanne & Dutoit, Stylistic walk synthesis based on Fourier decomposition): a walk as 271 numbers.

18 joints as exponential maps are 54 signals; each is a mean and two harmonics (amplitude and phase), and the cycle
frequency is common: 54 x 5 + 1 = 271. Walks of different style interpolate and extrapolate in this space. Joints
outside the eighteen stay in their mean posture; the hips' place, which the source does not model, is kept as three
more such signals beside the 271.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stimuli.cycle import PHASES, Cycle
from stimuli.methods.making import MethodError, check_speed, made_by
from stimuli.rotations import continuous, from_exponential, mean_rotation, to_exponential
from stimuli.skeleton import JOINTS, Floats

HARMONICS = 2
"""The fundamental and its first harmonic (equation 1)."""

EIGHTEEN: tuple[str, ...] = tuple(joint for joint in JOINTS if joint not in ("neck", "leftToes", "rightToes"))
"""The source's skeleton has 18 articulations; ours are all but the neck and the toes, which it does not name."""


@dataclass(frozen=True, eq=False)
class FourierWalk:
    """A walk as the parameters of equation 1, x(t) = p0 + sum over l of p_l cos(l w0 t + phi_l).

    joints:     J of the modelled joints
    frequency:  f0, cycles/s
    mean:       (J, 3) rad, p0 of the exponential maps
    amplitude:  (J, 3, L) rad, p_l; not negative
    phase:      (J, 3, L) rad, phi_l
    root:       (3, 1 + L) complex m: mean and 2 c_l of the hips' place
    source:     the cycle that was analysed: skeleton, stride length and posture of the other joints
    """

    joints: tuple[str, ...]
    frequency: float
    mean: Floats
    amplitude: Floats
    phase: Floats
    root: np.ndarray
    source: Cycle

    @property
    def numbers(self) -> Floats:
        """(J * 3 * (1 + 2 L) + 1,): p0, p_l and phi_l of every signal, and f0; 271 for 18 joints and 2 harmonics."""
        signals = np.concatenate([self.mean[..., None], self.amplitude, self.phase], axis=-1)
        return np.append(signals.ravel(), self.frequency)

    @property
    def complex(self) -> np.ndarray:
        """(J, 3, L): p_l e^(i phi_l) = 2 c_l, in which phases have no seam."""
        return np.asarray(self.amplitude * np.exp(1j * self.phase))


def fourier_walk(cycle: Cycle, harmonics: int = HARMONICS, joints: Sequence[str] = EIGHTEEN) -> FourierWalk:
    """Analysis of a cycle (equations 2 to 6); f0 is one over twice the mean step duration.

    joints: those to be modelled, of which the cycle has some. Raises MethodError for too few samples or no joints.
    """
    count = len(cycle.hips)
    if not 1 <= harmonics < count / 2:
        raise MethodError(f"{harmonics} harmonics cannot be taken from {count} samples; give 1 to {(count - 1) // 2}")
    chosen = tuple(joint for joint in cycle.joints if joint in joints)
    if not chosen:
        raise MethodError(f"{cycle.provenance.clip} has none of the joints {', '.join(joints)}")
    signals = exponential_signals(cycle, chosen)
    doubled = 2.0 * _coefficients(signals, harmonics)
    hips = np.concatenate([cycle.hips.mean(axis=0)[:, None], 2.0 * _coefficients(cycle.hips, harmonics)], axis=1)
    return FourierWalk(
        joints=chosen,
        frequency=1.0 / (2.0 * 0.5 * cycle.stride_time),
        mean=signals.mean(axis=0),
        amplitude=np.abs(doubled),
        phase=np.angle(doubled),
        root=hips,
        source=cycle,
    )


def synthesised(walk: FourierWalk, samples: int = PHASES) -> Cycle:
    """One cycle of the walk by equation 1, on the skeleton it was analysed from."""
    source = walk.source
    rotations = np.empty((samples, len(source.joints), 4))
    rotations[:] = mean_rotation(continuous(source.rotations))
    places = [source.joints.index(joint) for joint in walk.joints]
    rotations[:, places] = from_exponential(signals_at(walk, np.arange(samples) / samples))
    hips = _series(walk.root[:, 0].real, walk.root[:, 1:], np.arange(samples) / samples)
    return replace(
        source,
        rotations=continuous(rotations),
        hips=hips,
        stride_time=1.0 / walk.frequency,
        provenance=made_by("fourier", f"{len(walk.numbers)} numbers", source),
    )


def signals_at(walk: FourierWalk, cycles: Floats) -> Floats:
    """(M, J, 3) rad: equation 1 at times given in cycles (M,), any number of them: walks of any length."""
    return _series(walk.mean, walk.complex, cycles)


def between(first: FourierWalk, second: FourierWalk, share: float) -> FourierWalk:
    """The walk at `share` of the way from one style (0) to another (1); outside 0 to 1 it extrapolates.

    Means, harmonics (as p e^(i phi), so that phases of 359 and 1 degrees meet at 0) and f0 are linear; so are stride
    length and hips. Joints must be the same; bones need not be as long, for the source keeps proportions out of style:
    the walk made has the first one's. Raises MethodError for walks of other joints or of different order.
    """
    _check_alike(first, second)
    mean = second.mean + whole_turns(first.mean, second.mean)

    def mixed(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.asarray((1.0 - share) * a + share * b)

    harmonics = mixed(first.complex, second.complex)
    frequency = (1.0 - share) * first.frequency + share * second.frequency
    length = (1.0 - share) * first.source.stride_length + share * second.source.stride_length
    if frequency <= 0 or length <= 0:
        raise MethodError(f"{share:g} of the way from one walk to the other is too far: nothing would walk there")
    described = made_by("fourier", f"{100 * share:.0f} % of the second", first.source, second.source)
    return FourierWalk(
        joints=first.joints,
        frequency=frequency,
        mean=mixed(first.mean, mean),
        amplitude=np.abs(harmonics),
        phase=np.angle(harmonics),
        root=mixed(first.root, second.root),
        source=replace(first.source, stride_length=length, provenance=described),
    )


def fourier_to_speed(slower: Cycle, faster: Cycle, speed: float, harmonics: int = HARMONICS) -> Cycle:
    """A Fourier walk at `speed` (m/s) on the line through two captures of one person at different speeds."""
    check_speed(speed)
    span = faster.gait.speed - slower.gait.speed
    if abs(span) < 0.02:
        raise MethodError(
            f"{slower.provenance.clip} and {faster.provenance.clip} are both walked at {faster.gait.speed:.2f} m/s; "
            f"captures at two speeds are needed"
        )
    share = (speed - slower.gait.speed) / span
    cycle = synthesised(between(fourier_walk(slower, harmonics), fourier_walk(faster, harmonics), share))
    return replace(cycle, stride_time=cycle.stride_length / speed)


def variance_kept(walk: FourierWalk) -> dict[str, float]:
    """Joint -> share of the variance of its exponential map that the harmonics keep (1 for a joint that is still)."""
    signals = exponential_signals(walk.source, walk.joints)
    error = signals - signals_at(walk, walk.source.phases)
    total = np.sum((signals - signals.mean(axis=0)) ** 2, axis=(0, 2))
    lost = np.sum(error**2, axis=(0, 2))
    still = total < 1e-18
    kept = np.where(still, 1.0, 1.0 - lost / np.where(still, 1.0, total))
    return {joint: float(share) for joint, share in zip(walk.joints, kept, strict=True)}


def exponential_signals(cycle: Cycle, joints: Sequence[str]) -> Floats:
    """(N, J, 3) rad: exponential maps of these joints, without jumps along the cycle."""
    return unwrapped(to_exponential(cycle.rotations[:, [cycle.joints.index(joint) for joint in joints]]))


def unwrapped(vectors: Floats) -> Floats:
    """Exponential maps (N, ..., 3) rad made continuous along the first axis.

    v and v (1 + 2 pi n / |v|) are the same rotation (Grassia 1998); each sample takes the n nearest to the one
    before, so that a joint that turns past half a turn does not jump to the other side of the ball.
    """
    result = np.array(vectors, dtype=float)
    for sample in range(1, len(result)):
        result[sample] = result[sample] + whole_turns(result[sample - 1], result[sample])
    return result


def whole_turns(near: Floats, vectors: Floats) -> Floats:
    """(..., 3) rad: whole turns about the axes of `vectors` that bring them nearest to `near`."""
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    other = near / np.maximum(np.linalg.norm(near, axis=-1, keepdims=True), 1e-12)
    axis = np.where(angle > 1e-9, vectors / np.maximum(angle, 1e-12), other)
    count = np.round(np.sum((near - vectors) * axis, axis=-1, keepdims=True) / (2 * np.pi))
    return np.asarray(2 * np.pi * count * axis)


def _coefficients(signals: Floats, harmonics: int) -> np.ndarray:
    """(..., L) complex c_l = (1/N) sum over k of x_k e^(-i l w0 k) of signals (N, ...) (equations 3 and 4)."""
    spectrum = np.fft.rfft(signals, axis=0)[1 : harmonics + 1] / len(signals)
    return np.moveaxis(spectrum, 0, -1)


def _series(mean: Floats, doubled: np.ndarray, cycles: Floats) -> Floats:
    """(M, ...): mean + sum over l of Re(2 c_l e^(i l 2 pi t))."""
    orders = np.arange(1, doubled.shape[-1] + 1)
    waves = np.exp(2j * np.pi * np.outer(cycles, orders))
    return np.asarray(mean + np.einsum("ml,...l->m...", waves, doubled).real)


def _check_alike(first: FourierWalk, second: FourierWalk) -> None:
    if first.joints != second.joints or first.source.joints != second.source.joints:
        missing = sorted(set(first.source.joints) ^ set(second.source.joints))
        raise MethodError(f"the two walks are on different skeletons ({', '.join(missing)}); put them on one first")
    if first.amplitude.shape != second.amplitude.shape:
        orders = first.amplitude.shape[-1], second.amplitude.shape[-1]
        raise MethodError(f"one walk has {orders[0]} harmonics and the other {orders[1]}; analyse both alike")

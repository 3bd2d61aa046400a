"""All targets."""

from fuzzing.protocol_targets import PROTOCOL_TARGETS
from fuzzing.recording_targets import RECORDING_TARGETS
from fuzzing.target import Target
from fuzzing.yaml_targets import YAML_TARGETS

TARGETS: dict[str, Target] = {
    target.name: target for target in (*RECORDING_TARGETS, *YAML_TARGETS, *PROTOCOL_TARGETS)
}

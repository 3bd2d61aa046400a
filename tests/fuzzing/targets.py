"""All targets."""

from fuzzing.target import Target
from fuzzing.yaml_targets import YAML_TARGETS

TARGETS: dict[str, Target] = {target.name: target for target in (*YAML_TARGETS,)}

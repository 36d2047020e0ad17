import sys
sys.path.insert(0,'/tmp/body')
from dataclasses import dataclass, replace
from arm.body.landmarks import LimbMap, limb_map
from arm.body.limbs import limb
from arm.model import Arm, Body
import standin

@dataclass(frozen=True)
class LimbOfBody:
    name: str
    first: int
    arm: Arm
    where: LimbMap
    @property
    def is_leg(self): return "leg" in self.name

@dataclass(frozen=True)
class BodyMap:
    pelvis: int
    lumbar: int
    thorax: int
    limbs: tuple[LimbOfBody, ...]
    @property
    def links(self):
        found={'pelvis':self.pelvis,'thorax':self.thorax}
        for l in self.limbs:
            for s,p in l.where.parts.items(): found[s]=p.link+l.first
        return found

def whole(person):
    arm,m=standin.body(person)
    limbs=[]
    for name,o in m.firsts.items():
        a=limb(replace(person,preset=name)); limbs.append(LimbOfBody(name,o,a,limb_map(name,a.n_joint)))
    return arm, BodyMap(5,6,8,tuple(limbs))
WHOLE_BODY = "human-body"

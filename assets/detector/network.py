"""The network of the shipped detector: an EfficientNet-Lite0 that has seen ImageNet, a small
pyramid on top of it, and one head per stride that says class and box edges.

Edges are distributions over distances (Li et al. 2020, "Generalized focal loss"). The batch
normalization of the backbone is folded into its convolutions before training begins, as are mean
and deviation of the colors, so that the network takes RGB from 0 to 1.
"""

import math

import torch
from torch import nn
from torch.nn import functional as F

STRIDES = (8, 16, 32)
BINS = 16
# Kernel, stride, expansion, channels, repeats of EfficientNet-Lite0 (Tan & Le 2019) without its last stage.
STAGES = [
    (3, 1, 1, 16, 1),
    (3, 2, 6, 24, 2),
    (5, 2, 6, 40, 2),
    (3, 2, 6, 80, 3),
    (5, 1, 6, 112, 3),
    (5, 2, 6, 192, 4),
]
COLOR_MEAN = (0.485, 0.456, 0.406)
COLOR_STD = (0.229, 0.224, 0.225)


class SamePad(nn.Module):
    """A convolution padded the way the backbone was trained: more to the right and below."""

    def __init__(self, cin, cout, kernel, stride=1, groups=1, relu=True):
        super().__init__()
        total = kernel - stride if stride > 1 else kernel - 1
        before = total // 2
        self.pad = (before, total - before, before, total - before)
        symmetric = before == total - before
        self.conv = nn.Conv2d(cin, cout, kernel, stride, before if symmetric else 0, groups=groups)
        if symmetric:
            self.pad = None
        self.relu = relu

    def forward(self, x):
        if self.pad is not None:
            x = F.pad(x, self.pad)
        x = self.conv(x)
        return F.relu6(x) if self.relu else x


class Block(nn.Module):
    def __init__(self, cin, cout, kernel, stride, expand):
        super().__init__()
        mid = cin * expand
        self.expand = SamePad(cin, mid, 1) if expand > 1 else None
        self.depth = SamePad(mid, mid, kernel, stride, groups=mid)
        self.project = SamePad(mid, cout, 1, relu=False)
        self.skip = stride == 1 and cin == cout

    def forward(self, x):
        y = x if self.expand is None else self.expand(x)
        y = self.project(self.depth(y))
        return x + y if self.skip else y


class Backbone(nn.Module):
    """Features at strides 2, 4, 8, 16, 32 with 16, 24, 40, 112, 192 channels."""

    CHANNELS = (16, 24, 40, 112, 192)

    def __init__(self):
        super().__init__()
        self.stem = SamePad(3, 32, 3, 2)
        blocks, cin = [], 32
        self.taps = []
        for stage, (kernel, stride, expand, cout, repeats) in enumerate(STAGES):
            for i in range(repeats):
                blocks.append(Block(cin, cout, kernel, stride if i == 0 else 1, expand))
                cin = cout
            if stage != 3:
                self.taps.append(len(blocks) - 1)
        self.blocks = nn.ModuleList(blocks)

    def forward(self, x):
        out = []
        x = self.stem(x)
        for i, block in enumerate(self.blocks):
            x = block(x)
            if i in self.taps:
                out.append(x)
        return out

    @torch.no_grad()
    def load_imagenet(self, path):
        state = torch.load(path, map_location="cpu", weights_only=True)

        def put(layer, conv, norm):
            w = state[conv + ".weight"]
            scale = state[norm + ".weight"] / torch.sqrt(state[norm + ".running_var"] + 1e-3)
            assert layer.conv.weight.shape == w.shape, (conv, w.shape, layer.conv.weight.shape)
            layer.conv.weight.copy_(w * scale[:, None, None, None])
            layer.conv.bias.copy_(state[norm + ".bias"] - state[norm + ".running_mean"] * scale)

        put(self.stem, "_conv_stem", "_bn0")
        mean, std = torch.tensor(COLOR_MEAN), torch.tensor(COLOR_STD)
        w = self.stem.conv.weight
        self.stem.conv.bias -= (w * (mean / std)[None, :, None, None]).sum((1, 2, 3))
        w /= std[None, :, None, None]
        for i, block in enumerate(self.blocks):
            name = f"_blocks.{i}."
            if block.expand is not None:
                put(block.expand, name + "_expand_conv", name + "_bn0")
            put(block.depth, name + "_depthwise_conv", name + "_bn1")
            put(block.project, name + "_project_conv", name + "_bn2")


class Conv(nn.Module):
    """Convolution, normalization, SiLU."""

    def __init__(self, cin, cout, kernel=1, groups=1, act=True):
        super().__init__()
        self.conv = nn.Conv2d(cin, cout, kernel, 1, kernel // 2, groups=groups, bias=False)
        self.norm = nn.BatchNorm2d(cout, eps=1e-3, momentum=0.03)
        self.act = act

    def forward(self, x):
        x = self.norm(self.conv(x))
        return F.silu(x) if self.act else x


class Separable(nn.Module):
    """5×5 per channel, then across channels."""

    def __init__(self, cin, cout, kernel=5):
        super().__init__()
        self.depth = Conv(cin, cin, kernel, groups=cin, act=False)
        self.point = Conv(cin, cout)

    def forward(self, x):
        return self.point(self.depth(x))


class Head(nn.Module):
    def __init__(self, channels, classes):
        super().__init__()
        self.box = nn.Sequential(Conv(channels, 64, 3), Separable(64, 64), nn.Conv2d(64, 4 * BINS, 1))
        self.name = nn.Sequential(Separable(channels, 64), Separable(64, 64), nn.Conv2d(64, classes, 1))

    def start(self, stride, classes):
        nn.init.constant_(self.box[-1].bias, 1.0)
        # As if five objects were on an image of 640 pixels.
        nn.init.constant_(self.name[-1].bias, math.log(5 / classes / (640 / stride) ** 2))


class Detector(nn.Module):
    def __init__(self, classes=8, width=72):
        super().__init__()
        self.classes = classes
        self.backbone = Backbone()
        c2, c4, c8, c16, c32 = Backbone.CHANNELS
        # What is finer than the finest head goes into it pixel by pixel.
        self.fine2 = Conv(c2 * 16, 32)
        self.fine4 = Conv(c4 * 4, 40)
        self.in8, self.in16, self.in32 = Conv(c8, width), Conv(c16, width), Conv(c32, width)
        self.down16 = Separable(2 * width, width)
        self.down8 = nn.Sequential(Conv(2 * width + 72, width), Separable(width, width))
        self.up16 = Separable(2 * width, width)
        self.up32 = Separable(2 * width, width)
        self.heads = nn.ModuleList(Head(width, classes) for _ in STRIDES)
        for stride, head in zip(STRIDES, self.heads):
            head.start(stride, classes)
        self.register_buffer("bins", torch.arange(BINS, dtype=torch.float32), persistent=False)

    def features(self, x):
        f2, f4, f8, f16, f32 = self.backbone(x)
        p32 = self.in32(f32)
        p16 = self.down16(torch.cat([self.in16(f16), F.interpolate(p32, scale_factor=2.0)], 1))
        fine = [self.fine2(F.pixel_unshuffle(f2, 4)), self.fine4(F.pixel_unshuffle(f4, 2))]
        p8 = self.down8(torch.cat([self.in8(f8), F.interpolate(p16, scale_factor=2.0), *fine], 1))
        n16 = self.up16(torch.cat([F.max_pool2d(p8, 2), p16], 1))
        n32 = self.up32(torch.cat([F.max_pool2d(n16, 2), p32], 1))
        return p8, n16, n32

    def forward(self, x):
        """Per stride: 4×BINS logits of edges and one logit per class, N × channels × places."""
        edges, names = [], []
        for head, f in zip(self.heads, self.features(x)):
            edges.append(head.box(f).flatten(2))
            names.append(head.name(f).flatten(2))
        return torch.cat(edges, 2), torch.cat(names, 2)


def anchors(height, width, device=None):
    """Middles of the cells (pixels) and their strides, in the order of the network's output."""
    points, strides = [], []
    for s in STRIDES:
        h, w = height // s, width // s
        y, x = torch.meshgrid(torch.arange(h, device=device), torch.arange(w, device=device), indexing="ij")
        points.append((torch.stack([x, y], -1).reshape(-1, 2) + 0.5) * s)
        strides.append(torch.full((h * w,), float(s), device=device))
    return torch.cat(points), torch.cat(strides)


def boxes_of(edges, points, strides):
    """Corners in pixels, N × places × 4, from logits N × 4·BINS × places."""
    n, _, places = edges.shape
    share = edges.view(n, 4, BINS, places).softmax(2)
    bins = torch.arange(BINS, dtype=share.dtype, device=share.device)
    reach = (share * bins[None, None, :, None]).sum(2).transpose(1, 2) * strides[:, None]
    return torch.cat([points - reach[..., :2], points + reach[..., 2:]], -1)


class Exported(nn.Module):
    """What the file holds: 1×(4+classes)×places, boxes as middle and size in pixels."""

    def __init__(self, net, height, width):
        super().__init__()
        self.net = net
        points, strides = anchors(height, width)
        self.register_buffer("points", points.t()[None].contiguous())
        self.register_buffer("strides", strides[None, None])
        self.places = points.shape[0]

    def forward(self, x):
        edges, names = self.net(x)
        share = edges.view(1, 4, BINS, self.places).softmax(2)
        reach = (share * self.net.bins.view(1, 1, BINS, 1)).sum(2) * self.strides
        low, high = self.points - reach[:, :2], self.points + reach[:, 2:]
        return torch.cat([(low + high) / 2, high - low, names.sigmoid()], 1)


@torch.no_grad()
def fold(net):
    """Folds the remaining normalizations into their convolutions, in place."""
    for module in net.modules():
        if isinstance(module, Conv) and not isinstance(module.norm, nn.Identity):
            norm, conv = module.norm, module.conv
            scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            folded = nn.Conv2d(
                conv.in_channels, conv.out_channels, conv.kernel_size, 1, conv.padding, groups=conv.groups
            )
            folded.weight.copy_(conv.weight * scale[:, None, None, None])
            folded.bias.copy_(norm.bias - norm.running_mean * scale)
            module.conv, module.norm = folded, nn.Identity()
    return net

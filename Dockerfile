# docker build -t cdem .
# docker run --rm -v "$PWD:/work" cdem run case.yaml
FROM python:3.12-slim-bookworm AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ \
    && rm -rf /var/lib/apt/lists/*
COPY . /src
RUN pip wheel --no-cache-dir --no-deps -w /wheels /src

FROM python:3.12-slim-bookworm
# What pictures without a screen need, and OpenMP.
RUN apt-get update \
    && apt-get install -y --no-install-recommends libgomp1 libosmesa6 libgl1 libxrender1 \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir "$(echo /wheels/*.whl)[viz,sweep,terrain]" && useradd -m cdem
USER cdem
WORKDIR /work
ENTRYPOINT ["cdem"]
